"""The tables of the robot file that a service reads."""

from typing import Generic, NamedTuple

from giraff_core.network import NetworkConfig
from giraff_core.parameters.table import ConfigT
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import read_known


class Settings(NamedTuple, Generic[ConfigT]):
    """A service's own table, and those that all services share."""

    config: ConfigT
    """Its own table."""
    robot: RobotConfig
    network: NetworkConfig

    @classmethod
    def load(cls, service: str, config: type[ConfigT]) -> "Settings[ConfigT]":
        """Read them from robot file and environment. Raises ConfigError."""
        table = read_known().table
        return cls(table(service, config), table("robot", RobotConfig), table("network", NetworkConfig))
