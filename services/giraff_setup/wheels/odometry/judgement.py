"""What a calibration is worth on runs that the fit has not seen, in words, and as the table `[robot.calibration]`."""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

from giraff_core.kinematics.calibration import Calibration, Scales
from giraff_setup.wheels.odometry.fit import Fit
from giraff_setup.wheels.odometry.runs import Geometry, Run, end_errors, heading_errors
from giraff_tools.terminal.text import counted

_WHEEL_CHANGE: Final = 0.05
_TRACK_CHANGE: Final = 0.10
"""Of the value before: more is a slip of the measure more likely than a robot."""
_RESOLUTION: Final = 1e-4
"""m: of an end error. The robot file's digits alone make less than that."""
_SAME: Final = 0.1
"""Of its standard deviation: what a factor may be off and still be the one that was there. A fit of the same runs that
begins elsewhere comes out a third of that different.
"""
_FARTHEST: Final = 100.0
"""m that the robot file takes for an end error."""


class Checked(NamedTuple):
    """One run, by the scales before and after."""

    name: str
    before: float
    """m between where it ended and where odometry has it."""
    after: float
    heading_before: float
    """rad, never negative."""
    heading_after: float

    @property
    def is_worse(self) -> bool:
        """It ends farther off than before."""
        return self.after - self.before > _RESOLUTION


class Judgement(NamedTuple):
    """Of a fit, by runs that it has not seen; one at least."""

    runs: tuple[Checked, ...]

    @property
    def before(self) -> float:
        """m: mean end error."""
        return math.fsum(run.before for run in self.runs) / len(self.runs)

    @property
    def after(self) -> float:
        """m."""
        return math.fsum(run.after for run in self.runs) / len(self.runs)

    @property
    def refusal(self) -> str:
        """Why this calibration is not taken, whoever asks; empty: it is."""
        if self.after - self.before <= _RESOLUTION:
            return ""
        return (
            f"the checked runs end {self.after:.4f} m off on average, and {self.before:.4f} m by the values before: "
            "those stay; measure again, with longer runs, and see that no wheel slips"
        )

    @property
    def worse(self) -> tuple[str, ...]:
        """Runs that end farther off than before."""
        return tuple(run.name for run in self.runs if run.is_worse)


def judge(runs: Sequence[Run], geometry: Geometry, scales: Scales) -> Judgement:
    """`geometry.scales` are those before, `scales` those after."""
    columns = (
        end_errors(runs, geometry, geometry.scales),
        end_errors(runs, geometry, scales),
        heading_errors(runs, geometry, geometry.scales),
        heading_errors(runs, geometry, scales),
    )
    return Judgement(tuple(Checked(run.name, *row) for run, row in zip(runs, zip(*columns, strict=True), strict=True)))


def is_known_already(found: Fit, before: Scales) -> bool:
    """Whether a robot that was calibrated to `before` has these very scales, as far as the runs tell."""
    if before == Calibration().scales:  # nobody has calibrated it: how sure they are is new
        return False
    return all(abs(new - old) < _SAME * sd for new, old, sd in zip(found.scales, before, found.sd, strict=True))


def too_large_a_change(before: Scales, after: Scales) -> str:
    """Which scale is too far from the one before, in one line; empty: none."""
    limits = (_WHEEL_CHANGE, _WHEEL_CHANGE, _TRACK_CHANGE)
    for name, old, new, limit in zip(("left wheel", "right wheel", "track"), before, after, limits, strict=True):
        if abs(new / old - 1.0) > limit:
            return (
                f"the {name} would change by {100.0 * (new / old - 1.0):+.1f} %, more than {100.0 * limit:.0f} %: is "
                "it the right robot, are ticks_per_metre and track_width right, was all measured in m and rad? "
                "If so, give --force"
            )
    return ""


def table_of(found: Fit, judgement: Judgement, date: str) -> Calibration:
    """As the robot file has it, rounded; the covariance so little that it stays one."""
    left, right, track = (_digits(scale, 6) for scale in found.scales)
    aa, ab, ac, bb, bc, cc = (_digits(value, 9) for value in found.covariance)
    return Calibration(
        date=date,
        left_wheel_scale=left,
        right_wheel_scale=right,
        track_scale=track,
        covariance=(aa, ab, ac, bb, bc, cc),
        end_error_before=min(_digits(judgement.before, 4), _FARTHEST),
        end_error_after=min(_digits(judgement.after, 4), _FARTHEST),
    )


def in_words(found: Fit, judgement: Judgement, geometry: Geometry) -> str:
    """For whoever has measured it: what was found, how sure it is, and what it does to each checked run."""
    sds = found.sd
    rows = [
        ("left wheel", found.scales.left_wheel, sds[0], geometry.scales.left_wheel),
        ("right wheel", found.scales.right_wheel, sds[1], geometry.scales.right_wheel),
        ("track", found.scales.track, sds[2], geometry.scales.track),
    ]
    lines = ["                   found    ± sd   before"]
    lines += [f"{name:<12} {scale:11.5f} {sd:7.5f} {old:8.5f}" for name, scale, sd, old in rows]
    (ratio, ratio_sd), (track, track_sd) = found.wheel_ratio, found.track_ratio
    left = f"{math.degrees(found.yaw_residual):.2f}° (root mean square)"
    lines += [
        f"Right wheel over left (Ed): {ratio:.5f} ± {ratio_sd:.5f}; {_bend(ratio, geometry)}.",
        f"Track over wheels (Eb): {track:.5f} ± {track_sd:.5f}; {_turning(track, geometry)}.",
        f"What remains of {counted(found.windows, 'piece')} of way: {1000.0 * found.position_residual:.1f} mm, {left}.",
        "",
        f"{'checked run':<28} {'end error m':>16} {'heading error °':>20}",
    ]
    lines += [_checked(run) for run in judgement.runs]
    is_even = abs(judgement.after - judgement.before) <= _RESOLUTION
    percent = f"{100.0 * (judgement.after / (judgement.before or _RESOLUTION) - 1.0):+.0f} %"
    change = "as before" if is_even else percent
    lines.append(f"{'mean':<28} {judgement.before:7.4f} ->{judgement.after:7.4f}   {change}")
    lines += [f"Worse than before: {name}." for name in judgement.worse]
    lines += [f"Mind: {warning}." for warning in found.warnings]
    return "\n".join(lines)


def for_programs(found: Fit, judgement: Judgement, geometry: Geometry) -> dict[str, Any]:
    """The same; m and rad."""
    ratio, track = found.wheel_ratio, found.track_ratio
    return {
        "scales": {
            **found.scales._asdict(),
            "sd": dict(zip(found.scales._fields, found.sd, strict=True)),
            "covariance": list(found.covariance),
        },
        "scales_before": geometry.scales._asdict(),
        "geometry": {"ticks_per_metre": geometry.ticks_per_metre, "track_width": geometry.track_width},
        "wheel_ratio": {"value": ratio[0], "sd": ratio[1]},
        "track_ratio": {"value": track[0], "sd": track[1]},
        "noise": found.noise._asdict(),
        "residuals": {"windows": found.windows, "position": found.position_residual, "yaw": found.yaw_residual},
        "warnings": list(found.warnings),
        "end_error_before": judgement.before,
        "end_error_after": judgement.after,
        "checked": [{**run._asdict(), "worse": run.is_worse} for run in judgement.runs],
    }


def _digits(value: float, count: int) -> float:
    return float(f"{value:.{count}g}")


def _checked(run: Checked) -> str:
    headings = f"{math.degrees(run.heading_before):7.2f} ->{math.degrees(run.heading_after):6.2f}"
    return f"{run.name[-28:]:<28} {run.before:7.4f} ->{run.after:7.4f} {headings:>20}"


def _bend(ratio: float, geometry: Geometry) -> str:
    """What unequal wheels do."""
    degrees = math.degrees(abs(ratio - 1.0) / geometry.track_width)
    side = "left" if ratio > 1.0 else "right"
    return f"with equal counts the robot bends {degrees:.2f}° a metre to the {side}"


def _turning(track: float, geometry: Geometry) -> str:
    """What a wrong track does."""
    degrees = 360.0 * abs(1.0 / track - 1.0)
    less = "less" if track > 1.0 else "more"
    return f"in what would be a turn on a track of {geometry.track_width:g} m it turns {degrees:.1f}° {less}"
