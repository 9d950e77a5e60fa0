"""How a camera saw a drive, in numbers."""

from __future__ import annotations

import math
from typing import Final

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_schemas.camera import Step, VisualOdometry
from giraff_schemas.text import printable
from giraff_telemetry.localization import place_text
from giraff_tools.terminal.text import counted
from giraff_vision.policy import disagrees

_LABEL: Final = 15  # characters


class Path(msgspec.Struct, frozen=True, kw_only=True):
    """A path, and its end in the `base_link` of the first picture."""

    way_m: float = 0.0
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    """rad."""


class Summary(msgspec.Struct, kw_only=True):
    """As `--json` prints it."""

    camera: str = ""
    width: int = 0
    """px; size of the pictures."""
    height: int = 0
    seconds: float = 0.0
    """s from the first picture to the last."""
    pictures: int = 0
    measured: int = 0
    """Pictures that are a measurement."""
    reasons: dict[str, int] = {}
    """Pictures that are none, by what is wrong."""
    by_camera: Path = Path()
    """What was measured, and what the wheels say where nothing was."""
    blind_m: float = 0.0
    """m of it that are the wheels' word."""
    by_wheels: Path | None = None
    """None: they were not heard."""
    without_wheels: int = 0
    """Pictures after the first at which the wheels were not heard: `by_wheels` lacks their motion."""
    worst: tuple[float, Step, Step] | None = None
    """Largest disagreement: s since the first picture, and the motions since a key picture by camera and wheels."""


class Tally:
    """Takes what is said of each picture."""

    def __init__(self) -> None:
        self.summary = Summary()
        self._said: VisualOdometry | None = None
        self._first_ns = 0
        self._key_wheels = self._wheels = Pose(0.0, 0.0, 0.0)
        self._most_off = 0.0

    def add(self, said: VisualOdometry, at_ns: int) -> None:
        """Take the next. `at_ns`: when its picture was taken or heard, ns of any one clock."""
        summary, before, self._said = self.summary, self._said, said
        if before is None:
            self._first_ns = at_ns
        else:
            self._key_wheels = self._wheels if said.key != before.key else self._key_wheels
            summary.without_wheels += said.wheels is None
        summary.camera, summary.width, summary.height = said.camera, said.width, said.height
        summary.seconds = (at_ns - self._first_ns) * 1e-9
        summary.pictures += 1
        summary.measured += said.is_measured
        if why := said.reason.what:
            summary.reasons[why] = summary.reasons.get(why, 0) + 1
        x, y, yaw = said.path
        summary.by_camera = Path(way_m=said.seen_m + said.blind_m, x=x, y=y, yaw=yaw)
        summary.blind_m = said.blind_m
        if said.wheels is not None:
            wheels = Pose(*said.wheels).placed_in(self._key_wheels)
            way = 0.0 if summary.by_wheels is None else summary.by_wheels.way_m
            way += math.dist(wheels[:2], self._wheels[:2])
            summary.by_wheels = Path(way_m=way, x=wheels.x, y=wheels.y, yaw=wheels.yaw)
            self._wheels = wheels
        if disagrees(said) and said.motion and said.wheels:
            off = math.dist(said.motion, said.wheels)  # a metre counts as a radian
            if off > self._most_off:
                self._most_off, summary.worst = off, (summary.seconds, said.motion, said.wheels)


def to_text(summary: Summary) -> str:
    """For people."""
    of, wheels = summary.pictures, summary.by_wheels
    lacks = (
        f"; without {summary.without_wheels} pictures at which they were not heard" if summary.without_wheels else ""
    )
    size = f"{summary.width} x {summary.height} px"
    reasons = sorted(summary.reasons.items(), key=lambda each: -each[1])
    rows = [
        ("camera", f"{summary.camera}, {counted(of, 'picture')} in {summary.seconds:.1f} s, {size}"),
        ("measured", f"{summary.measured} of {counted(of, 'picture')}, {summary.measured / of:.1%}"),
        *(("not", f"{number} of {of}: {reason}") for reason, number in reasons),
        ("by the camera", f"{_path_text(summary.by_camera)}; {summary.blind_m:.2f} m of it by the wheels"),
        ("by the wheels", "not heard" if wheels is None else _path_text(wheels) + lacks),
    ]
    if summary.worst is not None:
        at_s, *steps = summary.worst
        camera, by = (f"{math.hypot(*step[:2]):.3f} m, {math.degrees(step[2]):z.1f}°" for step in steps)
        rows.append(("disagreed most", f"at {at_s:.1f} s: {camera} by the camera, {by} by the wheels"))
    return "\n".join(f"{label:>{_LABEL}}  {printable(value)}" for label, value in rows)


def _path_text(path: Path) -> str:
    return f"{path.way_m:.2f} m, to {place_text(path.x, path.y, path.yaw)}"
