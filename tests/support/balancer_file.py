"""The robot of deploy/robots/balancer.toml, with its wiring checked."""

from typing import Final

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_core.robot import RobotConfig
from giraff_sim.board import ROOT
from giraff_sim.dst.drill import known_settings

_settings = known_settings({"GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / "balancer.toml")})
_drive = _settings.base.drive
assert isinstance(_drive, BalancerConfig)
ROBOT: Final[RobotConfig] = _settings.robot
DRIVE: Final[BalancerConfig] = _drive
