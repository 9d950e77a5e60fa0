"""Asks a service of this machine how it is. Needs nothing but Python: see docs/health.md."""
