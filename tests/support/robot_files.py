"""The simulated robots of deploy/robots, on two wheels."""

from typing import Final, NamedTuple

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_node.config.robot_file import load
from giraff_sim.board import ROOT
from giraff_sim.config import SimConfig
from giraff_sim.dst.simulated_run import known_settings
from giraff_sim.settings import Settings


class FileRobot(NamedTuple):
    """One robot file."""

    settings: Settings
    drive: WheelsConfig
    sim: SimConfig


def _read(name: str, **given: str) -> FileRobot:
    environment = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robots" / f"{name}.toml"), **given}
    settings = known_settings(environment)
    assert isinstance(settings.base.drive, WheelsConfig)
    return FileRobot(settings, settings.base.drive, load("sim", SimConfig, environment))


ROBOTS: Final = {
    # As its first software had it: the simulated motors and encoders are soldered so, too.
    "ardros": _read("ardros", GIRAFF_BASE_DRIVE__INVERT_RIGHT_ENCODER="true"),
    "mega_l298n": _read("mega_l298n"),
    "mega_bts7960": _read("mega_bts7960"),
    "roboclaw": _read("roboclaw"),
    "ros_arduino_bridge": _read("ros_arduino_bridge"),
}
"""By the name of the file, which is its board's."""
ARDROS: Final = ROBOTS["ardros"]
