"""The robot of deploy/robots/balancer.toml, with its wiring checked."""

from typing import Final

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import load
from giraff_sim.board import ROOT
from giraff_sim.bodies.kinds import read_drive, with_known

_GIVEN: Final = with_known({"GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / "balancer.toml")})
_drive = read_drive(_GIVEN)
assert isinstance(_drive, BalancerConfig)
ROBOT: Final = load("robot", RobotConfig, _GIVEN)
DRIVE: Final[BalancerConfig] = _drive
