"""Gains of a robot that balances, from its masses and lengths."""
