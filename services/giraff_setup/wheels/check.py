"""`giraff check wheels`: a human, two lifted wheels and the base board find out how the robot is wired."""

import math
import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Final, TypeVar

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load, robot_file
from giraff_schemas.wire import Latch, Wiring
from giraff_setup.wheels.bench import BenchError, WheelBench
from giraff_setup.wheels.lifted import IN_DOUBT, NOT_BEGUN, Human, Terminal, ask_lifted, levels_of
from giraff_setup.wheels.wiring import (
    SIDES,
    Counted,
    DoubtError,
    MotorResponse,
    Side,
    Turned,
    encoder_of,
    encoder_that_counted,
    require_asked_power,
    require_both_ways,
    require_no_motion,
    require_right,
    wiring_of,
)
from giraff_tools.robot_file import RobotFileError, before_today, record, still_overriding
from giraff_tools.terminal.document import INTERRUPTED, Report, complain, print_report
from giraff_tools.terminal.output import DONE

AnswerT = TypeVar("AnswerT", bound=str)

_TABLE: Final = "base.drive"
_complain: Final = partial(complain, "check wheels")
_DRIVE_TIME: Final = 1.0  # s
_FULL_POWER: Final = 255
_NOT_JUDGED: Final = 255  # a stall level that is never reached: whose encoder is whose is not known yet
_TURNED: Final[tuple[Turned, ...]] = (*SIDES, "both", "none")

_ENCODER_BIT: Final[dict[Latch, Wiring]] = {
    Latch.LEFT_OPPOSITE: Wiring.INVERT_LEFT_ENCODER,
    Latch.RIGHT_OPPOSITE: Wiring.INVERT_RIGHT_ENCODER,
}


def check_wheels(port: str | None, *, as_json: bool = False) -> int:
    """Do the whole command; return its exit code. `as_json`: the talk goes to standard error."""
    return print_report(lambda report: _check(port, report), as_json=as_json)


def _check(port: str | None, report: Report) -> int:
    """Return the exit code, and report what was written where."""
    try:
        path = robot_file()
        robot = load("robot", RobotConfig)
        base = load("base", BaseConfig, os.environ, **({"port": port} if port else {}))
        port, drive = port or base.port, _of_wheels(path, base.drive)
    except ConfigError as error:
        return _complain(str(error), NOT_BEGUN)
    human = Terminal()
    try:
        if not ask_lifted(human, port):
            return _complain("not begun", NOT_BEGUN)
        bench = WheelBench(port, drive.board_type, robot.ticks_per_metre)
        try:
            bench.open()
            fields = find_wiring(bench, human, drive.stall_level, most_ticks(robot, drive))
        finally:
            bench.close()
        kept = record(path, _TABLE, fields, kept_as=before_today())
    except BenchError as error:
        return _complain(f"{error}. Nothing was written.", NOT_BEGUN)
    except DoubtError as error:
        return _complain(f"in doubt: {error}. Nothing was written.", IN_DOUBT)
    except RobotFileError as error:
        return _complain(str(error), IN_DOUBT)
    except KeyboardInterrupt:
        return _complain("interrupted; the motors are off. Nothing was written.", INTERRUPTED)
    human.show(_after(path, kept, fields, os.environ))
    report({"robot_file": str(path), "table": _TABLE, "wiring": fields})
    return DONE


def _of_wheels(path: Path, drive: object) -> WheelsConfig:
    if isinstance(drive, WheelsConfig):
        return drive
    raise ConfigError(f"{path}: [base.drive] is not of type wheels, whose wiring this finds; write its wiring by hand")


def most_ticks(robot: RobotConfig, drive: WheelsConfig) -> int:
    """Return the most ticks that a wheel may count in one drive at `stall_level`. At full power it counts more.

    The limit lies halfway, by ratio, between what the two levels give.
    """
    level = math.sqrt(drive.stall_level * _FULL_POWER)
    return round(robot.ticks_per_metre * robot.max_wheel_speed * level / drive.max_level * _DRIVE_TIME)


def find_wiring(bench: WheelBench, human: Human, level: int, most: int) -> dict[str, bool]:
    """The six fields of the robot file, found in one pass and proved in a second. Raises BenchError, DoubtError.

    `most`: ticks that a wheel may count in one drive at `level`.
    """
    first, second = (_probe(bench, human, side, level, most) for side in SIDES)
    fields = wiring_of(first, second)
    wiring = Wiring(0)
    for name, is_set in fields.items():
        if is_set:
            wiring |= Wiring[name.upper()]
    human.show("Found. Now the proof: each wheel forward and then backward, with the wiring that was found.")
    for side in SIDES:
        counted, latch = bench.drive(wiring, levels_of(side, level), _DRIVE_TIME, level)
        if latch != Latch.NONE:
            raise DoubtError(f"the board stopped the {side} wheel: {latch.name.lower()}; go through it again")
        require_right(side, counted)
        if _choice(human, f"Did the {side} wheel turn forward, and only that one?", ("yes", "no")) == "no":
            raise DoubtError("the proof does not agree with the answers before it; go through it again")
        backward, latch = bench.drive(wiring, levels_of(side, -level), _DRIVE_TIME, level)
        require_asked_power(f"the {side} wheel", backward, most)
        require_both_ways(side, counted, backward, latch)
    return fields


def _probe(bench: WheelBench, human: Human, side: Side, level: int, most: int) -> MotorResponse:
    """Drive the motor that is wired as `side`, with nothing inverted, and ask what happened."""
    motor = f"the {'first' if side == 'left' else 'second'} motor"
    human.show(f"{motor.capitalize()} turns one wheel for a second. Look at both.")
    wiring, counted = Wiring(0), Counted(0, 0)
    while True:
        counted, latch = bench.drive(wiring, levels_of(side, level), _DRIVE_TIME, _NOT_JUDGED)
        require_asked_power(motor, counted, most)
        if latch == Latch.NONE:
            break
        # The board protects itself from a wheel that turns against its level: its encoder counts the other way.
        if latch not in _ENCODER_BIT or wiring:
            raise DoubtError(
                f"the board stopped the motor: {latch.name.lower()}; check the plugs of motors and encoders"
            )
        wiring = _ENCODER_BIT[latch]
    counted = counted._replace(
        left=-counted.left if wiring & Wiring.INVERT_LEFT_ENCODER else counted.left,
        right=-counted.right if wiring & Wiring.INVERT_RIGHT_ENCODER else counted.right,
    )
    human.show(f"The encoders counted {counted.left} and {counted.right}.")
    seen = _ask_what_turned(human, counted)
    if seen.wheel == "none" and encoder_that_counted(counted) is None:
        human.show("It is tried backward, for a second.")
        require_no_motion(motor, bench.drive(wiring, levels_of(side, -level), _DRIVE_TIME, _NOT_JUDGED)[0])
    encoder_of(seen)  # in doubt already
    return seen


def _ask_what_turned(human: Human, counted: Counted) -> MotorResponse:
    wheel: Turned = _choice(human, "Which wheel turned, as seen by one who sits on the robot?", _TURNED)
    if wheel not in SIDES:
        return MotorResponse(counted, wheel, forward=True)
    way = _choice(human, "Which way, as if the robot drove on it?", ("forward", "backward"))
    return MotorResponse(counted, wheel, forward=way == "forward")


def _choice(human: Human, question: str, answers: tuple[AnswerT, ...]) -> AnswerT:
    """One of the answers, or its first letter."""
    for _ in range(3):
        given = human.ask(f"{question} [{'/'.join(answers)}]")
        for answer in answers:
            if given in (answer, answer[0]):
                return answer
    raise DoubtError(f"no answer was one of {', '.join(answers)}")


def _after(path: Path, kept: Path | None, fields: Mapping[str, bool], environment: Mapping[str, str]) -> str:
    lines = [
        f"Proved, and written into {path}; as it was before: {kept}:",
        *(f"    {name} = {str(is_set).lower()}" for name, is_set in fields.items()),
    ]
    if overriding := still_overriding({"base.drive": fields}, environment):
        lines.append(overriding)
    lines.append("Copy the file to the other machines, and start giraff_base.")
    return "\n".join(lines)
