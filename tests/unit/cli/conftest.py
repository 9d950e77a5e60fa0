"""The fixture that all tests of commands have."""

from tests.unit.cli.typed import giraff

__all__ = ["giraff"]
