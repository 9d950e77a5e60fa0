"""Where the robot is on the map, as localization has it: walls, particles, how sure it is, and where else it may be."""

from typing import Any, Final

import rerun as rr

from giraff_schemas.localization import Candidate, MapPose, MapWalls, Particles
from giraff_viewer.colours import CANDIDATES, PARTICLES, PLACES, WALLS
from giraff_viewer.rows import FLOOR, Row, planar
from giraff_viewer.shapes import Strip, ellipse, headings, placed

_WALLS: Final = f"{FLOOR}/walls"
_PARTICLES: Final = f"{FLOOR}/particles"
_PLACE: Final = f"{FLOOR}/place"
_CANDIDATES: Final = f"{FLOOR}/candidates"
_BELOW: Final = 5.0
"""In rerun's order of drawing, in which lines have 20."""


class Whereabouts:
    """Of one robot. All of it is in `map`; what odometry tells hangs below, and moves with each correction."""

    def __init__(self, outline: list[Strip], heading: float) -> None:
        """`outline`: of the robot, in `base_link`; `heading`: m that it is drawn ahead."""
        self._outline, self._heading = outline, heading
        self._walls: tuple[tuple[float, float, float, float], ...] = ()
        self._candidates: tuple[Candidate, ...] = ()
        self.known = False
        """A place was heard, so that `odom` is put there."""

    def begin(self) -> list[Row]:
        """In which frame it is."""
        return [(path, rr.CoordinateFrame("map")) for path in (_WALLS, _PARTICLES, _PLACE, _CANDIDATES)]

    def on_sample(self, sample: MapPose | Particles | MapWalls) -> list[Row]:
        """What a sample changes."""
        match sample:
            case MapPose():
                return self._locate(sample)
            case Particles():
                points = list(zip(sample.x, sample.y, strict=True))
                return [(_PARTICLES, rr.Points2D(points, colors=[PARTICLES], radii=[0.012], draw_order=_BELOW))]
            case MapWalls():
                return self._build(sample)

    def _build(self, walls: MapWalls) -> list[Row]:
        """The floor plan; it is told again and again."""
        if walls.walls == self._walls:
            return []
        self._walls = walls.walls
        strips = [[(x, y), (to_x, to_y)] for x, y, to_x, to_y in walls.walls]
        return [(_WALLS, rr.LineStrips2D(strips, colors=[WALLS], radii=[0.02], draw_order=_BELOW))]

    def _locate(self, pose: MapPose) -> list[Row]:
        """The best place, and the others."""
        if pose.state == "no_map":
            return []
        self.known = True
        rows = [planar("map", "odom", pose.odom.x, pose.odom.y, pose.odom.yaw), (_PLACE, self._place(pose))]
        if pose.candidates != self._candidates:
            self._candidates = pose.candidates
            rows.append((_CANDIDATES, self._others(pose.candidates)))
        return rows

    def _place(self, pose: MapPose) -> Any:
        """Within which it is with 95 %, and the headings; its colour says whether that may be believed."""
        xx, xy, _, yy, _, tt = pose.covariance
        ways = [placed(way, pose.x, pose.y, pose.yaw) for way in headings(tt, self._heading)]
        strips = [placed(ellipse(xx, xy, yy), pose.x, pose.y, 0.0), *ways]
        return rr.LineStrips2D(strips, colors=[PLACES[pose.state]], radii=[0.012])

    def _others(self, candidates: tuple[Candidate, ...]) -> Any:
        strips = [placed(strip, each.x, each.y, each.yaw) for each in candidates for strip in self._outline]
        labels = [
            f"{100.0 * each.belief:.0f} %" if strip is self._outline[0] else ""
            for each in candidates
            for strip in self._outline
        ]
        return rr.LineStrips2D(strips, colors=[CANDIDATES], radii=[0.008], labels=labels)
