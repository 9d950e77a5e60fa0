"""Leads a person and the robot before a wall: distances by tape, rests on the way, a slow turn both ways."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Final, NamedTuple, Protocol

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_core.motion.result import MotionResult
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_schemas.motion import Move, Step, Turn
from giraff_setup.ultrasonic.fit import Echo, SensorFit, UntoldError, Wall, fit, wall_of
from giraff_tools.terminal.human import Human, agrees
from giraff_tools.typed import number

SPEED: Final = 0.15  # m/s
TURN_SPEED: Final = 0.2  # rad/s
PINGS: Final = 100
"""Number of pings of each sensor at each rest."""
LEG: Final = 0.4
"""m between two rests."""
LEGS: Final = 2
_SWING: Final = math.radians(40.0)
_SWINGS: Final = (Turn(angle=_SWING), Turn(angle=-2 * _SWING), Turn(angle=2 * _SWING), Turn(angle=-_SWING))
_NEAREST, _FARTHEST = 0.7, 1.3
"""m from the wall where it begins."""
_TYPED_WITHIN: Final = 0.1
"""m by which the second distances may differ from what odometry makes of the first."""
_MOST_OFF: Final = 0.1
"""m that y or z may differ from the file: more is a slip."""
_ASIDE: Final = math.radians(45.0)
_AT_REST, _AT_REST_YAW = 0.01, math.radians(1.0)  # m, rad that odometry may tell of a robot that rests

INTRODUCTION: Final = f"""\
Park the robot square before a bare, flat wall, front towards it, {_NEAREST} to {_FARTHEST} m away. The wall is to be
bare 1.2 m to either side, and nothing may stand beside the robot. Measure along the floor, from the wall to where each
wheel touches the floor, to 3 mm: the two distances tell how square the robot stands. Ctrl-C ends it all, stops the
robot and writes nothing."""


class StoppedError(Exception):
    """It cannot go on. The message says why, and what to do."""


class Stand(Protocol):
    """The robot before the wall."""

    def place(self) -> Pose:
        """Return odometry's pose. Raises StoppedError."""
        ...

    def listen(self, sensors: Sequence[str], pings: int) -> list[Echo]:
        """Return so many pings of each, or what came in time. Raises StoppedError."""
        ...

    def perform(self, steps: Sequence[Step]) -> tuple[MotionResult, list[Echo]]:
        """Do a motion; return how it arrived, and the pings meanwhile. Raises StoppedError where it did not."""
        ...

    def idle(self) -> str:
        """Go on hearing while the person types; return what to show."""
        ...


class Measured(NamedTuple):
    """The outcome of one sensor."""

    filed: Ultrasonic
    """The robot file's, with y and z as the person has typed them."""
    found: SensorFit | None
    """None: it stays as it is."""
    why: str = ""
    """Reason why nothing was found; empty: something was."""


def measure(human: Human, stand: Stand, robot: RobotConfig, pings: int = PINGS) -> dict[str, Measured]:
    """Measure all ultrasonic sensors of the robot. Raises StoppedError and NobodyError."""
    sensors = robot.of(Ultrasonic)
    filed = {name: pose for name, pose in sensors.items() if looks(pose) is not None}
    measured = {
        name: Measured(pose, None, "it looks aside, and no wall is there")
        for name, pose in sensors.items()
        if name not in filed
    }
    if not robot.calibration.date:
        raise StoppedError(
            "the wheels were never calibrated, and the way between two rests is not known well enough; "
            "call `giraff calibrate odometry` first"
        )
    if not filed:
        raise StoppedError("no ultrasonic sensor of the robot file looks ahead or back; correct [robot.sensors]")
    human.show(INTRODUCTION)
    filed = {name: _ruled(human, stand, name, pose) for name, pose in filed.items()}
    sides = {way: {name: pose for name, pose in filed.items() if looks(pose) is way} for way in (True, False)}
    wall = _ask_wall(human, stand, robot, ahead=True)
    back, turn = LEG * LEGS, math.degrees(_SWING)
    then = (
        f", turns round, turns {turn:.0f}° to either side and backs {back:.1f} m towards the wall"
        if sides[False]
        else ""
    )
    if not agrees(
        human, f"The robot now backs {back:.1f} m, turns {turn:.0f}° to either side{then}. Is the way free? [yes/no]"
    ):
        raise StoppedError("not begun; clear the way, then call it again")
    if sides[True]:
        measured |= _measure_side(human, stand, sides[True], wall, pings, ahead=True)
    else:
        _perform(human, stand, [Move(distance=-back)], "It backs.")
    if sides[False]:
        _perform(human, stand, [Turn(angle=math.pi)], "It turns round.")
        expected = wall.distance_from(stand.place())
        wall = _ask_wall(human, stand, robot, ahead=False, expected=expected)
        measured |= _measure_side(human, stand, sides[False], wall, pings, ahead=False)
    return measured


def looks(pose: Ultrasonic) -> bool | None:
    """Return True of a sensor that looks ahead, False of one that looks back, None of others."""
    yaw = abs(math.remainder(pose.yaw, math.tau))
    return True if yaw < _ASIDE else False if yaw > math.pi - _ASIDE else None


def _measure_side(
    human: Human, stand: Stand, sensors: Mapping[str, Ultrasonic], wall: Wall, pings: int, *, ahead: bool
) -> dict[str, Measured]:
    """Rest, drive away from the wall or back to it, and turn at the far end."""
    rests, turn, way_sd = [], list[Echo](), 0.0
    for leg in range(LEGS + 1):
        if leg:
            result, _ = _perform(human, stand, [Move(distance=-LEG)], "It backs.")
            way_sd = max(way_sd, result.standard_deviations[0] / LEG)
        human.show(f"It listens for {pings} pings of {', '.join(sensors)}.")
        before = stand.place()
        rests.append(stand.listen(list(sensors), pings))
        if has_moved(before, stand.place()):
            raise StoppedError("the robot moved while it was to listen; see that nobody drives it, and begin again")
        if leg == (LEGS if ahead else 0):
            _, turn = _perform(human, stand, _SWINGS, "It turns to either side.")
    measured = {}
    for name, pose in sensors.items():
        own: list[list[Echo]] = [[echo for echo in echoes if echo.sensor == name] for echoes in (*rests, turn)]
        try:
            measured[name] = Measured(pose, fit(pose, wall, own[:-1], own[-1], way_sd))
        except UntoldError as error:
            measured[name] = Measured(pose, None, str(error))
    return measured


def has_moved(before: Pose, after: Pose) -> bool:
    """Tell whether a robot that was to rest did not."""
    turned = abs(math.remainder(after.yaw - before.yaw, math.tau))
    return math.dist(before[:2], after[:2]) > _AT_REST or turned > _AT_REST_YAW


def _perform(human: Human, stand: Stand, steps: Sequence[Step], words: str) -> tuple[MotionResult, list[Echo]]:
    human.show(words)
    return stand.perform(steps)


def _ruled(human: Human, stand: Stand, name: str, pose: Ultrasonic) -> Ultrasonic:
    """Ask for y and z of a sensor, by ruler."""
    y = _ask(
        human, stand, f"{name}: m left of the robot's middle line, right negative; ENTER keeps {pose.y:g}:", pose.y
    )
    z = _ask(human, stand, f"{name}: m above the floor; ENTER keeps {pose.z:g}:", pose.z, within=2.0)
    return msgspec.structs.replace(pose, y=y, z=z)


def _ask(human: Human, stand: Stand, question: str, before: float, within: float = _MOST_OFF) -> float:
    while True:
        answer = human.ask(question, stand.idle)
        try:
            value = number(answer) if answer else before
        except ValueError as error:
            human.show(f"{error}.")
            continue
        if abs(value - before) <= within:
            return value
        human.show(f"{value:g} m is more than {within:g} m off {before:g} m. Are these millimetres? Type it once more.")


def _ask_wall(human: Human, stand: Stand, robot: RobotConfig, *, ahead: bool, expected: float | None = None) -> Wall:
    """Ask for the distances of both wheels while the robot stands."""
    low, high = (_NEAREST, _FARTHEST) if expected is None else (expected - _TYPED_WITHIN, expected + _TYPED_WITHIN)
    where = "" if ahead else " once more, for it has turned round"
    while True:
        left, right = (
            ask_number(human, f"From the wall to where the {side} wheel touches the floor{where}:", stand.idle)
            for side in ("left", "right")
        )
        try:
            wall = wall_of(stand.place(), left, right, robot.kinematics.track_width, ahead=ahead)
        except ValueError as error:
            human.show(f"{error}.")
            continue
        if low <= wall.distance <= high:
            return wall
        human.show(f"The middle would be {wall.distance:.3f} m from the wall, and not {low:.2f} to {high:.2f} m.")


def ask_number(human: Human, question: str, meanwhile: Callable[[], str]) -> float:
    """Ask until a number is typed; `meanwhile`: as of `Human.ask`."""
    while True:
        try:
            return number(human.ask(question, meanwhile))
        except ValueError as error:
            human.show(f"{error}.")
