"""The wheels' encoder counts become a pose."""
