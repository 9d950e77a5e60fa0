"""What a simulated robot is made of: its configuration, its services, and where they run."""

from collections.abc import Callable
from typing import Final, NamedTuple

import msgspec

from giraff_base.config import BaseConfig
from giraff_base.service import Base
from giraff_core.io import IO, Service
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_guard.service import Guard
from giraff_joystick.config import JoystickConfig
from giraff_joystick.service import Joystick
from giraff_motion.config import MotionConfig
from giraff_motion.service import Motion
from giraff_odometry.config import OdometryConfig
from giraff_odometry.service import Odometry
from giraff_ranger.config import RangerConfig
from giraff_ranger.service import Ranger
from giraff_schemas.services import SERVICES


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """Configuration of the robot and its services."""

    robot: RobotConfig
    joystick: JoystickConfig = JoystickConfig(port="joystick")
    base: BaseConfig
    ranger: RangerConfig = RangerConfig(port="ranger")
    guard: GuardConfig = GuardConfig(deceleration=1.5)
    odometry: OdometryConfig = OdometryConfig()
    motion: MotionConfig = MotionConfig()


class Services(NamedTuple):
    """What runs in each process: what ships, unless a test breaks something."""

    joystick: Callable[[IO, JoystickConfig, RobotConfig], Service] = Joystick
    ranger: Callable[[IO, RangerConfig, RobotConfig], Service] = Ranger
    guard: Callable[[IO, GuardConfig, RobotConfig], Service] = Guard
    base: Callable[[IO, BaseConfig, RobotConfig], Service] = Base
    odometry: Callable[[IO, OdometryConfig, RobotConfig], Service] = Odometry
    motion: Callable[[IO, MotionConfig, RobotConfig], Service] = Motion


MACHINES: Final = {name: service.host for name in Services._fields for service in SERVICES if service.name == name}
"""By service: the machine it runs on."""
STARTED: Final = tuple(service for service in MACHINES if service != "motion")
"""Those that run from the beginning: a motion drives nothing until somebody asks for one."""
