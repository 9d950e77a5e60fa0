"""The robot of deploy/robots/balancer.toml, with its wiring checked."""

from typing import Final

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_node.config.robot_file import load
from giraff_sim.board import ROOT
from giraff_sim.config import SimConfig
from giraff_sim.dst.simulated_run import known_settings

_GIVEN: Final = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / "balancer.toml")}
BALANCER: Final = known_settings(_GIVEN)
SIM: Final = load("sim", SimConfig, _GIVEN)
ROBOT: Final = BALANCER.robot
_drive = BALANCER.base.drive
assert isinstance(_drive, BalancerConfig)
DRIVE: Final[BalancerConfig] = _drive
