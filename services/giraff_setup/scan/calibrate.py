"""`giraff calibrate scan`: a laser scanner, from the first turn on the spot to the robot file."""

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import msgspec

from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_setup.scan.fit import BIAS_SD, Mount
from giraff_setup.scan.procedure import ScannedRobot, Surveyed, check, survey
from giraff_setup.scan.stand import ScanStand
from giraff_setup.ultrasonic.calibrate import lead, write
from giraff_setup.ultrasonic.fit import UntoldError
from giraff_setup.ultrasonic.procedure import StoppedError
from giraff_tools.robot_file import RobotFileError, rehearse
from giraff_tools.terminal.document import REFUSED, UNUSABLE, Report, complain, no_report
from giraff_tools.terminal.human import Human, NobodyError, agrees

_COMMAND: Final = "calibrate scan"
_complain: Final = partial(complain, _COMMAND)
_FAR_OFF: Final = 3.0  # standard deviations by which the two ways may differ


def calibrate_scan(robot: str | None, connect: Sequence[str], file: Path | None, *, as_json: bool = False) -> int:
    """Do the whole command; return its exit code. `file`: as of `own_robot_file`.

    `as_json`: the talk goes to standard error.
    """
    return lead(_COMMAND, ScanStand, guide, robot, connect, file, as_json=as_json)


def guide(human: Human, stand: ScannedRobot, filed: RobotConfig, path: Path, report: Report = no_report) -> int:
    """Measure, tell, ask and write into `path`, which says `filed`; return the exit code."""
    scanners = filed.of(LaserScanner)
    if not scanners:
        return _complain(f'{path} has no laser scanner; write [robot.sensors.laser] with type = "ld19"', UNUSABLE)
    try:
        rehearse(path, {f"robot.sensors.{name}": {"x": scanner.x, "own": []} for name, scanner in scanners.items()})
    except RobotFileError as error:
        return _complain(str(error), UNUSABLE)
    try:
        found = survey(human, stand, scanners, filed.footprint_radius)
        before = scanners[found.name]
        human.show(in_words(before, found))
        fields = changed(before, found)
        checked = check(human, stand, before, found)
        question = f"Write {found.name} into {path}? [yes/no]"
        if checked is not None:
            mount, bias = checked
            human.show(compared(found.mount, mount, bias))
            if off := disagreement(found.mount, mount):
                question = f"{off}. Write what the motion found all the same? [yes/no]"
        if not agrees(human, question, stand.idle):
            return _complain("not wanted. Nothing was written.", REFUSED)
        stand.wait_released()
    except (StoppedError, UntoldError) as error:
        return _complain(f"{error}. Nothing was written.", REFUSED)
    except NobodyError:
        return _complain("nobody answers. Nothing was written.", UNUSABLE)
    return write(human, _COMMAND, {found.name: fields}, path, report)


def changed(before: LaserScanner, found: Surveyed) -> dict[str, Any]:
    """Return the fields of the robot file. Raises UntoldError where no robot file takes them."""
    place = {name: round(getattr(found.mount, name), 4) for name in ("x", "y", "yaw")}
    own = [[round(begin, 4), round(end, 4)] for begin, end in found.own]
    try:
        msgspec.structs.replace(before, **place, own=tuple((begin, end) for begin, end in own))
    except ValueError as error:
        raise UntoldError(str(error)) from error
    return {**place, "upside_down": found.upside_down, "own": own}


def in_words(before: LaserScanner, found: Surveyed) -> str:
    """Tell the person what was found, how sure it is, and what was before."""
    mount = found.mount
    rows = [
        ("x", f"{mount.x:.3f} ± {mount.x_sd:.3f} m", f"{before.x:.3f} m"),
        ("y", f"{mount.y:.3f} ± {mount.y_sd:.3f} m", f"{before.y:.3f} m"),
        ("yaw", f"{_degrees(mount.yaw):.1f} ± {math.degrees(mount.yaw_sd):.1f}°", f"{_degrees(before.yaw):.1f}°"),
        ("upside_down", *("yes" if each.upside_down else "no" for each in (found, before))),
        ("own", _arcs(found.own), "not measured" if before.own is None else _arcs(before.own)),
    ]
    table = [f"{found.name:<14}{'found':<28}before", *(f"{what:<14}{now:<28}{was}" for what, now, was in rows)]
    return "\n".join([*found.words, *table])


def compared(motion: Mount, step: Mount, bias: float | None) -> str:
    """Tell the person what the wall says beside the motion."""
    told = (
        f"By the wall, x is {step.x:.3f} ± {step.x_sd:.3f} m (by motion {motion.x:.3f}), y {step.y:.3f} ± "
        f"{step.y_sd:.3f} m ({motion.y:.3f}), yaw {_degrees(step.yaw):.1f} ± {math.degrees(step.yaw_sd):.1f}° "
        f"({_degrees(motion.yaw):.1f}). "
    )
    if bias is not None:
        return f"{told}Its ranges are {abs(bias) * 1000.0:.0f} mm too {'long' if bias > 0.0 else 'short'}."
    return f"{told}The bias of its ranges, up to {BIAS_SD * 1000.0:.0f} mm, goes into this x."


def disagreement(motion: Mount, step: Mount) -> str:
    """Return in which the two ways disagree; empty: in nothing."""
    off = [
        name
        for name in ("x", "y", "yaw")
        if abs(math.remainder(getattr(motion, name) - getattr(step, name), math.tau))
        > _FAR_OFF * math.hypot(getattr(motion, f"{name}_sd"), getattr(step, f"{name}_sd"))
    ]
    return f"Motion and wall disagree about {' and '.join(off)}; measure the distance once more" if off else ""


def _degrees(angle: float) -> float:
    return math.degrees(math.remainder(angle, math.tau))


def _arcs(own: Sequence[tuple[float, float]]) -> str:
    return ", ".join(f"{_degrees(begin):.0f} to {_degrees(end):.0f}°" for begin, end in own) or "hides nothing"
