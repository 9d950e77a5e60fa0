"""The simulated robot of deploy/robots/ardros.toml."""

from typing import Final

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_node.config.robot_file import load
from giraff_sim.board import ROOT
from giraff_sim.config import SimConfig
from giraff_sim.dst.simulated_run import known_settings

_GIVEN: Final = {
    "GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / "ardros.toml"),
    "GIRAFF_BASE_DRIVE__INVERT_RIGHT_ENCODER": "true",
}
"""As its first software had it: the simulated motors and encoders are soldered so, too."""
ARDROS: Final = known_settings(_GIVEN)
_drive = ARDROS.base.drive
assert isinstance(_drive, WheelsConfig)
DRIVE: Final[WheelsConfig] = _drive
SIM: Final = load("sim", SimConfig, _GIVEN)
