"""`giraff check encoders`: two lifted wheels turn, and the board tells how their encoders' channels change."""

import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load, robot_file
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import Latch, Wiring
from giraff_setup.encoder.advice import advice
from giraff_setup.encoder.quadrature import Channel, Figures, analyse
from giraff_setup.encoder.traces import Trace, drawing, traces
from giraff_setup.encoder.transitions import Listener, MuteBoardError
from giraff_setup.wheels.bench import RESTLESS, BenchError, RestlessError, WheelBench
from giraff_setup.wheels.lifted import IN_DOUBT, NOT_BEGUN, Human, Terminal, ask_lifted, levels_of
from giraff_setup.wheels.wiring import SIDES, Counted, DoubtError, Side
from giraff_tools.terminal.document import INTERRUPTED, Report, complain, print_report
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.output import DONE, guard_stdout, require_fresh, write_fresh
from giraff_tools.terminal.page import print_table, print_wrapped

_complain: Final = partial(complain, "check encoders")
_DRIVE_TIME: Final = 4.0  # s, 0.8 m at 0.2 m/s: a turn of a disk on the wheel's own shaft, many of one on the motor's
_HEADINGS: Final = ("wheel", ">phase", ">A high", ">B high", ">A missing", ">B missing", ">pair")


class _Wheel(NamedTuple):
    """The figures of one wheel, and its faults."""

    figures: Figures
    troubles: list[Trouble]
    restless: Sequence[Side]
    """Wheels whose encoders counted on after it was driven."""


def check_encoders(port: str | None, svg: Path | None, *, as_json: bool = False) -> int:
    """Do the whole command; return its exit code. `as_json`: the talk goes to standard error."""
    gone = "standard output was closed before both wheels were judged; the motors are off"
    return guard_stdout(
        lambda: print_report(lambda report: _check(port, svg, report), as_json=as_json),
        unfinished=f"giraff check encoders: {gone}",
    )


def _check(port: str | None, svg: Path | None, report: Report) -> int:
    """Return the exit code, and report what was found."""
    try:
        robot = load("robot", RobotConfig)
        base = load("base", BaseConfig, os.environ, **({"port": port} if port else {}))
        drive = _checkable(robot_file(), base.drive)
        if svg is not None:
            require_fresh(svg)
    except (ConfigError, OSError, ValueError) as error:
        return _complain(str(error), NOT_BEGUN)
    port, human = port or base.port, Terminal()
    wheels = dict[Side, _Wheel]()
    try:
        if not ask_lifted(human, port):
            return _complain("not begun", NOT_BEGUN)
        bench = WheelBench(port, drive.board_type, robot.ticks_per_metre)
        try:
            bench.open()
            for side in SIDES:
                wheels[side] = _check_wheel(bench, human, side, drive)
            for side in SIDES:
                if any(side in wheel.restless for wheel in wheels.values()):
                    wheels[side].troubles.append(Trouble(f"it {RESTLESS.what}", RESTLESS.remedy).of(f"{side} wheel"))
        finally:
            bench.close()
    except MuteBoardError:
        advice = drive.board_type.flash_advice(port)
        return _complain(f"{port}: the board's firmware does not tell transitions; {advice}", NOT_BEGUN)
    except (BenchError, DoubtError) as error:
        return _complain(str(error), NOT_BEGUN)
    except KeyboardInterrupt:
        return _complain("interrupted; the motors are off.", INTERRUPTED)
    report({side: _as_json(wheel) for side, wheel in wheels.items()})
    return _conclude(wheels, svg)


def _checkable(path: Path, drive: object) -> WheelsConfig:
    """ConfigError unless the encoders of this drive can be looked at."""
    if not isinstance(drive, WheelsConfig):
        raise ConfigError(f"{path}: [base.drive] is not of type wheels, whose encoders this looks at")
    if not drive.board_type.tells_transitions:
        raise ConfigError(
            f"{path}: a board of type {drive.board} cannot tell its encoders' transitions; "
            "look at both channels with an oscilloscope, or a logic analyser"
        )
    if drive.unchecked:
        raise ConfigError(f"{path}: {drive.unchecked}")
    return drive


def _check_wheel(bench: WheelBench, human: Human, side: Side, drive: WheelsConfig) -> _Wheel:
    """Drive one wheel forward, and judge its encoder."""
    human.show(f"The {side} wheel turns forward for {_DRIVE_TIME:g} s.")
    listener = Listener(SIDES.index(side) ^ int(Wiring.SWAP_ENCODERS in drive.wiring))
    level = drive.stall_level
    restless: Sequence[Side] = ()
    try:
        counted, latch = bench.drive(drive.wiring, levels_of(side, level), _DRIVE_TIME, level, listener)
    except RestlessError as error:
        counted, latch, restless = error.counted, error.latch, error.sides
    figures = analyse(listener.transitions)
    troubles = [each.of(f"{side} wheel") for each in _troubles(figures, side, counted, latch)]
    return _Wheel(figures, troubles, restless)


def _troubles(figures: Figures, side: Side, counted: Counted, latch: Latch) -> list[Trouble]:
    """Name what is wrong with a wheel and its encoder, the cause before what follows from it."""
    if not figures.is_enough and abs(getattr(counted, side)) < counted.fewest:
        other: Side = "right" if side == "left" else "left"
        if abs(getattr(counted, other)) >= counted.fewest:
            what = f"it was driven, and the encoder of the {other} wheel counted"
            return [Trouble(what, "run giraff check wheels")]
        return [
            Trouble(
                "it was driven, and its encoder gave nothing",
                "check battery, motor plug and encoder plug; raise stall_level if the wheel only hums",
            )
        ]
    troubles = list(advice(figures))
    if latch in (Latch.LEFT_OPPOSITE, Latch.RIGHT_OPPOSITE) and not troubles:
        troubles.append(Trouble("it counts backward while it is driven forward", "run giraff check wheels"))
    elif latch != Latch.NONE:
        word = latch.name.lower()
        troubles.append(Trouble(f"the board stopped it: {word}", "put right what is named before, and check once more"))
    return troubles


def _conclude(wheels: Mapping[Side, _Wheel], svg: Path | None) -> int:
    """Show what was found; return the exit code."""
    captions = {side: _caption(side, wheel.figures) for side, wheel in wheels.items()}
    drawn = {side: trace for side, wheel in wheels.items() if (trace := Trace.of(wheel.figures)) is not None}
    for side, trace in drawn.items():
        print(f"\n{captions[side]}")
        for line in traces(trace, dots=takes_dots()):
            print(line)
    print()
    print_table(_HEADINGS, [(side, *_cells(wheel.figures)) for side, wheel in wheels.items()])
    print()
    troubles = [trouble for wheel in wheels.values() for trouble in wheel.troubles]
    for trouble in troubles:
        print_wrapped(f"{trouble}.")
    if not troubles:
        print("Both encoders are fine.")
    if svg is not None and drawn:
        try:
            write_fresh(svg, drawing([(captions[side], trace) for side, trace in drawn.items()]))
        except OSError as error:
            return _complain(f"{svg} cannot be written: {error.strerror}", IN_DOUBT)
        print(f"{svg}: the traces of A and B.")
    return IN_DOUBT if troubles else DONE


def _caption(side: Side, figures: Figures) -> str:
    phase = "" if figures.phase is None else f": {figures.leads} leads by {figures.phase:.0f} of 360 degrees"
    return f"{side} wheel{phase}"


def _cells(figures: Figures) -> list[str]:
    phase = "-" if figures.phase is None else f"{figures.phase:.0f} ± {figures.spread * 360:.0f}°"
    duties = [
        "-" if each.duty is None else f"{each.duty * 100:.0f} ± {each.duty_spread * 100:.0f} %"
        for _, each in figures.channels
    ]
    missing = [_missing(name, channel, figures) for name, channel in figures.channels]
    return [phase, *duties, *missing, f"{figures.period_ms:.1f} ms" if figures.period_ms else "-"]


def _missing(name: str, channel: Channel, figures: Figures) -> str:
    if figures.silent == name or not figures.is_enough:
        return "-"
    if channel.turn is not None:
        return f"{channel.turn.marks} in {channel.turn.states} states"
    return str(channel.missing)


def _as_json(wheel: _Wheel) -> dict[str, Any]:
    figures = wheel.figures
    return {
        "transitions": figures.transitions,
        "losses": figures.losses,
        "period_ms": figures.period_ms,
        "b_after_a": figures.b_after_a,
        "b_after_a_spread": figures.spread,
        **{
            name.lower(): channel._asdict() | {"turn": channel.turn and channel.turn._asdict()}
            for name, channel in figures.channels
        },
        "troubles": wheel.troubles,
    }
