"""How a camera saw a drive, in numbers."""

from __future__ import annotations

import math
from collections import Counter
from typing import Final

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_schemas.camera import Step, VisualOdometry
from giraff_schemas.text import printable
from giraff_telemetry.localization import place_text

_LABEL: Final = 15  # characters
_START: Final = Pose(0.0, 0.0, 0.0)


class Path(msgspec.Struct, frozen=True, kw_only=True):
    """A path, and its end in the `base_link` of the first picture."""

    way_m: float
    x: float
    y: float
    yaw_deg: float


class Disagreement(msgspec.Struct, frozen=True, kw_only=True):
    """Two motions since one key picture, of which one is wrong."""

    at_s: float
    """s since the first picture."""
    camera: Step
    wheels: Step


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """As `--json` prints it."""

    camera: str
    width: int
    """px; size of the pictures."""
    height: int
    seconds: float
    """s from the first picture to the last."""
    pictures: int
    measured: int
    """Pictures that are a measurement."""
    reasons: dict[str, int]
    """Pictures that are none, by their reason, the most frequent first."""
    by_camera: Path
    """What was measured, and what the wheels say where nothing was."""
    blind_m: float
    """m of it that are the wheels' word."""
    by_wheels: Path | None
    """None: they were not heard."""
    without_wheels: int
    """Pictures after the first at which the wheels were not heard: `by_wheels` lacks their motion."""
    worst: Disagreement | None
    """The largest disagreement of camera and wheels."""


class Tally:
    """Takes what is said of each picture."""

    def __init__(self) -> None:
        self.pictures = self._measured = self._without_wheels = 0
        self._reasons: Counter[str] = Counter()
        self._first_ns = self._last_ns = 0
        self._said: VisualOdometry | None = None
        self._key_wheels = self._wheels = _START
        self._wheels_m = self._most_off = 0.0
        self._worst: Disagreement | None = None

    def take(self, said: VisualOdometry, at_ns: int) -> None:
        """Take the next. `at_ns`: when its picture was taken or heard, ns of any one clock."""
        if self._said is None:
            self._first_ns = at_ns
        else:
            self._key_wheels = self._wheels if said.key != self._said.key else self._key_wheels
            self._without_wheels += said.wheels is None
        self._said, self._last_ns = said, at_ns
        self.pictures += 1
        self._measured += said.is_measured
        if said.reason:
            self._reasons[said.reason] += 1
        if said.wheels is None:
            return
        wheels = Pose(*said.wheels).placed_in(self._key_wheels)
        self._wheels_m += math.dist(wheels[:2], self._wheels[:2])
        self._wheels = wheels
        if said.reason and said.motion is not None:
            off = math.dist(said.motion, said.wheels)  # a metre counts as a radian
            if off > self._most_off:
                at_s = (at_ns - self._first_ns) * 1e-9
                self._most_off = off
                self._worst = Disagreement(at_s=round(at_s, 3), camera=said.motion, wheels=said.wheels)

    def summary(self) -> Summary:
        """Return it. There was a picture."""
        said = self._said
        assert said is not None  # noqa: S101  as its caller knows
        heard = self._without_wheels < self.pictures - 1
        return Summary(
            camera=said.camera,
            width=said.width,
            height=said.height,
            seconds=round((self._last_ns - self._first_ns) * 1e-9, 3),
            pictures=self.pictures,
            measured=self._measured,
            reasons=dict(self._reasons.most_common()),
            by_camera=_path(said.seen_m + said.blind_m, said.path),
            blind_m=round(said.blind_m, 3),
            by_wheels=_path(self._wheels_m, self._wheels) if heard else None,
            without_wheels=self._without_wheels,
            worst=self._worst,
        )


def to_text(summary: Summary) -> str:
    """For people."""
    of = summary.pictures
    rows = [
        ("camera", f"{summary.camera}, {of} pictures of {summary.width} x {summary.height} in {summary.seconds:.1f} s"),
        ("measured", f"{summary.measured} of {of} pictures, {summary.measured / of:.1%}"),
        *(("not", f"{number} of {of}: {reason}") for reason, number in summary.reasons.items()),
        ("by the camera", f"{_path_text(summary.by_camera)}; {summary.blind_m:.2f} m of it by the wheels"),
        ("by the wheels", "not heard" if summary.by_wheels is None else _path_text(summary.by_wheels)),
    ]
    if (worst := summary.worst) is not None:
        both = f"{_step_text(worst.camera)} by the camera, {_step_text(worst.wheels)} by the wheels"
        rows.append(("disagreed most", f"at {worst.at_s:.1f} s: {both}; one of the two is wrong"))
    return "\n".join(f"{label:>{_LABEL}}  {printable(value)}" for label, value in rows)


def _path(way: float, end: Step) -> Path:
    x, y, yaw = end
    return Path(way_m=round(way, 3), x=round(x, 4), y=round(y, 4), yaw_deg=round(math.degrees(yaw), 3))


def _path_text(path: Path) -> str:
    return f"{path.way_m:.2f} m, to {place_text(path.x, path.y, math.radians(path.yaw_deg))}"


def _step_text(step: Step) -> str:
    return f"{math.hypot(*step[:2]):.2f} m, {math.degrees(step[2]):z.1f}°"
