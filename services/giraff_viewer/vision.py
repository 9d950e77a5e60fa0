"""Visual odometry: its path on the floor, and on the picture what it looks at."""

import math
from itertools import pairwise
from textwrap import wrap
from typing import Final

import rerun as rr

from giraff_core.kinematics.pose import Pose
from giraff_schemas.camera import Pixel, VisualOdometry
from giraff_schemas.messages import Odometry
from giraff_viewer.colours import AMBER, BLIND, GREEN, GREY, RED, VISUAL
from giraff_viewer.event_text import drawable
from giraff_viewer.pictures import OLD, picture_path
from giraff_viewer.rows import FLOOR, Row, planar
from giraff_viewer.shapes import Point, Trail

PATH: Final = f"{FLOOR}/visual"
_FRAME: Final = "visual_path"
"""The `base_link` of the first picture."""
_DOT: Final = -2.5
_LINE: Final = -1.0
"""Points of the screen; rerun wants them negative."""
_COLUMNS: Final = 44
"""Characters in a line of a reason."""


class Vision:
    """One robot. Times are ns of the listener's clock."""

    def __init__(self) -> None:
        self._trail = Trail()
        self._blind_m = 0.0
        """At the trail's last point."""
        self._begun: tuple[str, tuple[str, int]] | None = None
        self._moved = False
        self._marked: dict[str, int] = {}
        """By camera, when its picture was marked."""

    def begin(self) -> list[Row]:
        """Return the frame of the path."""
        return [(PATH, rr.CoordinateFrame(_FRAME))]

    def on_sample(self, sample: VisualOdometry, then: Odometry | None, shown: Point | None, at_ns: int) -> list[Row]:
        """Return what a sample draws.

        `then`: odometry of the picture's moment. `shown`: width and height of the picture on the screen; None: there is
        none.
        """
        rows = self._mark(sample, shown, at_ns) if shown is not None else []
        if then is None:
            return rows
        x, y, yaw = sample.path
        if self._begun != (begun := (sample.instance, then.segment)):
            self._begun = begun
            first = Pose(0.0, 0.0, 0.0).seen_from(Pose(x, y, yaw)).placed_in(Pose(then.x, then.y, then.yaw))
            rows.append(planar("odom", _FRAME, *first))
        if self._trail.go_on(x, y, begun, unseen=sample.blind_m > self._blind_m):
            self._blind_m = sample.blind_m
            self._moved = True
        return rows

    def draw_path(self) -> list[Row]:
        """Return the path, if it has changed: the wheels' word is thinner and darker."""
        if not self._moved:
            return []
        self._moved = False
        strips: list[list[Point]] = []
        blind: list[bool] = []
        for (before, _), (after, unseen) in pairwise(zip(self._trail.points, self._trail.unseen, strict=True)):
            if not strips or blind[-1] != unseen:
                strips.append([before])
                blind.append(unseen)
            strips[-1].append(after)
        colours, radii = [BLIND if each else VISUAL for each in blind], [0.008 if each else 0.014 for each in blind]
        return [(PATH, rr.LineStrips2D(strips, colors=colours, radii=radii, draw_order=25.0))]

    def update(self, now_ns: int) -> list[Row]:
        """Return what takes the marks of a picture away when no newer ones follow."""
        old = [camera for camera, at_ns in self._marked.items() if now_ns - at_ns > OLD * 1e9]
        for camera in old:
            del self._marked[camera]
        return [(_marks(camera), rr.Clear(recursive=True)) for camera in old]

    def _mark(self, sample: VisualOdometry, shown: Point, at_ns: int) -> list[Row]:
        self._marked[sample.camera] = at_ns
        width, height = shown
        scale = width / sample.width if sample.width else 0.0

        def placed(pixels: tuple[Pixel, ...]) -> list[Point]:
            return [((column + 0.5) * scale, (row + 0.5) * scale) for column, row in pixels]

        lines = wrap(f"no visual odometry: {sample.reason}{_both(sample)}", _COLUMNS) if sample.reason else []
        ground = [placed(sample.ground + sample.ground[:1])] if sample.ground else []
        top, why = [(width / 2.0, height * 0.1)] if lines else [], ["\n".join(map(drawable, lines))]
        marks = {
            "ground": rr.LineStrips2D(ground, colors=[GREY], radii=[_LINE]),
            "rejected": rr.Points2D(placed(sample.rejected), colors=[RED], radii=[_DOT]),
            "tracked": rr.Points2D(placed(sample.tracked), colors=[GREEN], radii=[_DOT]),
            "reason": rr.Points2D(top, labels=why, colors=[AMBER], radii=[1.0]),
        }
        return [(f"{_marks(sample.camera)}/{name}", mark) for name, mark in marks.items()]


def _both(sample: VisualOdometry) -> str:
    """Return the motions of picture and wheels, of a picture that was seen and is not believed."""
    if sample.motion is None or sample.wheels is None:
        return ""
    steps = sample.motion, sample.wheels
    seen, rolled = (f"{math.hypot(x, y):.2f} m and {math.degrees(yaw):z.0f}°" for x, y, yaw in steps)
    return f" (picture: {seen}, wheels: {rolled})"


def _marks(camera: str) -> str:
    return f"{picture_path(camera)}/vision"
