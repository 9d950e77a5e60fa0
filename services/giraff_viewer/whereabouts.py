"""The robot on the map, as localization has it: walls, particles, how sure it is, and where else it may be.

The map's places by name, its no-go lines and a route that goes on are drawn with it.
"""

from typing import Any, Final

import rerun as rr

from giraff_schemas.localization import Candidate, MapPose, MapWalls, Particles
from giraff_schemas.places import NoGoLine, Place, Places, RouteState
from giraff_viewer.colours import CANDIDATES, NAMED, NO_GO, PARTICLES, PLACES, ROUTE, WALLS
from giraff_viewer.rows import FLOOR, Row, planar
from giraff_viewer.shapes import Strip, ellipse, headings, placed

_WALLS: Final = f"{FLOOR}/walls"
_PARTICLES: Final = f"{FLOOR}/particles"
_PLACE: Final = f"{FLOOR}/place"
_CANDIDATES: Final = f"{FLOOR}/candidates"
_NAMED: Final = f"{FLOOR}/named_places"
_NO_GO: Final = f"{FLOOR}/no_go"
_ROUTE: Final = f"{FLOOR}/route"
_GOAL: Final = f"{FLOOR}/goal"
_ARROW: Final[Strip] = [(-0.1, 0.06), (0.15, 0.0), (-0.1, -0.06), (-0.1, 0.06)]
"""m. A place by name, which points to where the robot faces there."""
_BELOW: Final = 5.0
"""In rerun's order of drawing, in which lines have 20."""

_Drawn = tuple[tuple[Place, ...], tuple[NoGoLine, ...]]
"""Places and no-go lines."""


class Whereabouts:
    """Of one robot. All of it is in `map`; what odometry tells hangs below, and moves with each correction."""

    def __init__(self, outline: list[Strip], heading: float) -> None:
        """`outline`: of the robot, in `base_link`; `heading`: m that it is drawn ahead."""
        self._outline, self._heading = outline, heading
        self._walls: tuple[tuple[float, float, float, float], ...] = ()
        self._map = ""
        self._places: Places | None = None
        self._drawn: _Drawn = (), ()
        self._route: tuple[Strip, str] = [], ""
        """Corners of the route that is drawn, and the name of its goal."""
        self._candidates: tuple[Candidate, ...] = ()
        self.known = False
        """A place was heard, so that `odom` is put there."""

    def begin(self) -> list[Row]:
        """In which frame it is."""
        paths = (_WALLS, _PARTICLES, _PLACE, _CANDIDATES, _NAMED, _NO_GO, _ROUTE, _GOAL)
        return [(path, rr.CoordinateFrame("map")) for path in paths]

    def on_sample(self, sample: MapPose | Particles | MapWalls | Places | RouteState) -> list[Row]:
        """What a sample changes."""
        match sample:
            case MapPose():
                return self._locate(sample)
            case Particles():
                points = list(zip(sample.x, sample.y, strict=True))
                return [(_PARTICLES, rr.Points2D(points, colors=[PARTICLES], radii=[0.012], draw_order=_BELOW))]
            case MapWalls():
                self._map = sample.map
                return self._build(sample) + self._draw_places()
            case Places():
                self._places = sample
                return self._draw_places()
            case RouteState():
                return self._draw_route(sample)

    def _build(self, walls: MapWalls) -> list[Row]:
        """The floor plan; it is told again and again."""
        if walls.walls == self._walls:
            return []
        self._walls = walls.walls
        strips = [[(x, y), (to_x, to_y)] for x, y, to_x, to_y in walls.walls]
        return [(_WALLS, rr.LineStrips2D(strips, colors=[WALLS], radii=[0.02], draw_order=_BELOW))]

    def _draw_places(self) -> list[Row]:
        """Draw places and no-go lines when they change. Those of another plan do not count."""
        known = self._places
        wanted: _Drawn = (), ()
        if known is not None and known.are_on(self._map):
            wanted = known.places, known.no_go
        if wanted == self._drawn:
            return []
        places, lines = self._drawn = wanted
        arrows = [placed(_ARROW, each.x, each.y, each.yaw) for each in places]
        names = [each.name for each in places]
        ends = [[(each.x, each.y), (each.end_x, each.end_y)] for each in lines]
        return [
            (_NAMED, rr.LineStrips2D(arrows, colors=[NAMED], radii=[0.015], labels=names)),
            (_NO_GO, rr.LineStrips2D(ends, colors=[NO_GO], radii=[0.02])),
        ]

    def _draw_route(self, state: RouteState) -> list[Row]:
        """Draw a route when it changes, as long as it goes on."""
        ended = state.stage in ("idle", "ended")
        corners, name = wanted = ([], "") if ended else (list(state.corners), state.place)
        if wanted == self._route:
            return []
        self._route = wanted
        return [
            (_ROUTE, rr.LineStrips2D([corners] if corners else [], colors=[ROUTE], radii=[0.02])),
            (_GOAL, rr.Points2D(corners[-1:], colors=[ROUTE], radii=[0.06], labels=[name] if name else [])),
        ]

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
