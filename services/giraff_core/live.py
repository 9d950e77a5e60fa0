"""The configuration that is in force, in the one place from which all parts of a service read it."""

from typing import Generic, TypeVar

import msgspec

ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)


class Live(Generic[ConfigT]):
    """Read each value where it is used. A part that kept one would go by it after it was set to another."""

    def __init__(self, config: ConfigT) -> None:
        self.config = config

    def replace(self, config: ConfigT) -> None:
        """Put another configuration in force, between two turns."""
        self.config = config
