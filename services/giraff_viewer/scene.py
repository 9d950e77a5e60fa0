"""Samples in, rerun's archetypes out. Nothing is sent from here: the rows say what is drawn where.

Frames are REP-105's, `map` → `odom` → `base_link`. A drawing's y points down, theirs up: `floor` is `map` turned about
x. Until localization tells where `odom` is in `map`, they are the same.
"""

import math
from collections import deque
from typing import Any, Final

import msgspec
import rerun as rr
from rerun.components import AggregationPolicy

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import Evidence, Ultrasonic, typed
from giraff_schemas.camera import Picture, VisualOdometry
from giraff_schemas.localization import MapPose, MapWalls, Particles
from giraff_schemas.messages import GuardState, Odometry, Range, RobotTime, Sample, Tick, Tilt, TruePose
from giraff_schemas.places import Places, RouteState
from giraff_schemas.requests import EchoMap
from giraff_schemas.topics import Topic
from giraff_viewer.colours import ELLIPSE, EVIDENCE, GREY, LEVELS, LINES, PATH, ROBOT, TILT, TRUTH, WHITE, Colour
from giraff_viewer.event_text import EventText, Line
from giraff_viewer.evidence import EvidenceState, SensorEvidence
from giraff_viewer.pictures import Pictures
from giraff_viewer.plots import Series, Values, balance_series, series
from giraff_viewer.rows import FLOOR, Row, planar, turned
from giraff_viewer.shapes import Point, Trail, arc, ellipse, grid, headings, outline, placed
from giraff_viewer.surroundings import Surroundings
from giraff_viewer.vision import Vision
from giraff_viewer.whereabouts import Whereabouts

_KEPT: Final = 100  # odometry samples: a second, more than a true pose is late


class Ghost:
    """Compares where a simulated robot truly is with where odometry has it, both of the same moment.

    They are not heard at the same one, and the robot drives between.
    """

    def __init__(self) -> None:
        self._samples: deque[Odometry] = deque(maxlen=_KEPT)

    def on_odometry(self, odometry: Odometry) -> None:
        """Odometry's newest sample. One that was restarted, or whose pose was set, has another frame from there on."""
        if self._samples and self._samples[-1].segment != odometry.segment:
            self._samples.clear()
        self._samples.append(odometry)

    def at(self, tick: RobotTime | None) -> Odometry | None:
        """Return odometry of a moment of the last second; None: it says nothing of that time."""
        of_its_time = [sample for sample in self._samples if tick is not None and sample.tick.epoch == tick.epoch]
        if tick is None or not of_its_time or tick.robot_ns < of_its_time[0].tick.robot_ns:
            return None
        return min(of_its_time, key=lambda sample: abs(sample.tick.robot_ns - tick.robot_ns))

    def apart(self, truth: TruePose) -> Pose | None:
        """The true robot in the `base_link` of odometry; None: odometry says nothing of that time."""
        if (then := self.at(truth.tick)) is None:
            return None
        return Pose(truth.x, truth.y, truth.yaw).seen_from(Pose(then.x, then.y, then.yaw))


LOG: Final = "log"
GRID: Final = f"{FLOOR}/grid"
NUMBERS: Final = f"{GRID}/numbers"
GUARD: Final = "guard"
HAND: Final = "hand"
_EVIDENCE: Final = f"{FLOOR}/evidence"
_THICK: Final = 0.02  # m
_ABOVE: Final = 21.0  # order of drawing, over other lines

_PLOT_EVERY: Final = 40_000_000  # ns between two points of a line; a screen shows no more
_TRAIL_EVERY: Final = 500_000_000  # ns
_ECHOES_EVERY: Final = 1_000_000_000  # ns
_UNPLACED_EVERY: Final = 5_000_000_000  # ns; a viewer with little memory forgets what is older than its newest data
_FARTHEST: Final = 30  # m from the middle of `map` that lines are drawn: more are no help to the eye
_HEADING: Final = 1.5  # radii of the robot
_GRAVITY: Final = 9.81  # m/s²


Wall = tuple[float, float, float, float]
"""m. From x, y to x, y."""


class Scene:
    """One robot. Times are ns of one clock, that of whoever heard it."""

    def __init__(self, robot: RobotConfig, note: str = "") -> None:
        """`note`: stands beside the robot; it says by what the robot is drawn where not by its own word."""
        self._robot, self._note = robot, note
        self._evidence = {name: SensorEvidence(name, robot) for name in robot.sensor_types}
        self._drawn: dict[str, tuple[EvidenceState, Evidence]] = {}
        self._outline = outline(robot.footprint_radius, robot.track_width)
        self._whereabouts = Whereabouts(self._outline, _HEADING * robot.footprint_radius)
        self._surroundings = Surroundings(robot)
        self._ghost = Ghost()
        self._pictures = Pictures()
        self._vision = Vision()
        self._trail = Trail()
        self._spread: tuple[int, int, int, int] | None = None
        self._moved = False
        self._event_text = EventText()
        self._page = ""
        self._values = Values()
        self._last: dict[str, int] = {}

    def begin(self) -> list[Row]:
        """What never changes: frames that are fixed, outlines, the colours of the lines."""
        upside_up, labels = turned(1.0, 0.0, 0.0, math.pi), [self._note] if self._note else []
        rows: list[Row] = [
            (FLOOR, rr.CoordinateFrame("floor")),
            ("frames/map", rr.Transform3D(**upside_up, parent_frame="floor", child_frame="map")),
            *self._whereabouts.begin(),
            *self._vision.begin(),
            *self._surroundings.begin(),
            *((path, rr.CoordinateFrame("map")) for path in (GRID, NUMBERS)),
            (f"{FLOOR}/path", rr.CoordinateFrame("odom")),
            (f"{FLOOR}/ellipse", rr.CoordinateFrame("odom")),
            (f"{FLOOR}/truth", rr.CoordinateFrame("base_link")),
            (f"{FLOOR}/robot", rr.CoordinateFrame("base_link")),
            (f"{FLOOR}/robot", rr.LineStrips2D(self._outline, colors=[ROBOT], radii=[0.015], labels=labels)),
            (f"{HAND}/level", rr.LineStrips2D([arc(1.0, math.tau, 48), arc(0.5, math.tau, 48)], colors=[GREY])),
        ]
        rows += [(f"{_EVIDENCE}/{sensor}", rr.CoordinateFrame("base_link")) for sensor in self._evidence]
        return rows + _styles(series(tuple(self._robot.of(Ultrasonic))))

    def clear(self) -> list[Row]:
        """Return what takes the evidence away: another scene has other sensors."""
        return [(_EVIDENCE, rr.Clear(recursive=True))]

    def begin_balance(self) -> list[Row]:
        """Return what never changes of a robot that balances."""
        return _styles(balance_series())

    @property
    def balances(self) -> bool:
        """Whether the robot has told its attitude."""
        return self._values.balances

    @property
    def cameras(self) -> tuple[str, ...]:
        """Those that a picture was heard of."""
        return self._pictures.cameras

    def on_sample(self, topic: Topic[Any], sample: Sample, at_ns: int) -> list[Row]:
        """What a sample changes."""
        values = self._values.of(sample)
        rows = [(path, rr.Scalars([value])) for path, value in values if self._due(path, _PLOT_EVERY, at_ns)]
        match sample:
            case Odometry():
                rows += self._move(sample, at_ns)
            case TruePose():
                rows += self._draw_truth(sample, at_ns)
            case Range():
                self._surroundings.on_sample(sample)
            case MapPose() | Particles() | MapWalls() | Places() | RouteState():
                rows += self._whereabouts.on_sample(sample)
                rows += self._draw_map(sample.walls if isinstance(sample, MapWalls) else ())
            case Tick() | Picture():
                rows += self._pictures.on_sample(sample, at_ns)
            case VisualOdometry():
                then, shown = self._ghost.at(sample.tick), self._pictures.size(sample.camera)
                rows += self._vision.on_sample(sample, then, shown, at_ns)
            case Tilt() if self._due(HAND, _PLOT_EVERY, at_ns):
                rows.append((f"{HAND}/tilt", _tilt(sample)))
            case GuardState():
                rows += self._judge(sample, at_ns)
        each = self._evidence.get(getattr(sample, "sensor", ""))
        if each is not None and each.on_sample(topic, sample, at_ns):
            rows += self._draw_evidence(at_ns)
        return rows + self._say(self._event_text.on_sample(sample))

    def begin_with(self, earlier: EchoMap) -> None:
        """Take where echoes came from before anybody looked."""
        self._surroundings.begin_with(earlier)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> list[Row]:
        """A service has come or gone."""
        there = ("INFO", f"is there, {instance}") if present else ("WARN", f"is gone, {instance}")
        return self._say(self._event_text.add(f"service {service}", there))

    def update(self, now_ns: int) -> list[Row]:
        """What the time that passes changes: a sensor that is silent, a way that is longer than its line."""
        rows = self._draw_evidence(now_ns) + self._draw_trail(now_ns)
        if self._due("echoes", _ECHOES_EVERY, now_ns):
            rows += self._surroundings.draw_echoes()
        return rows + self._pictures.update(now_ns) + self._vision.update(now_ns)

    def _judge(self, guard: GuardState, at_ns: int) -> list[Row]:
        for each in self._evidence.values():
            each.judge(guard)
        return self._draw_evidence(at_ns)

    def _move(self, odometry: Odometry, at_ns: int) -> list[Row]:
        rows: list[Row] = []
        self._ghost.on_odometry(odometry)
        self._surroundings.on_sample(odometry)
        if self._due("frames/base_link", _PLOT_EVERY, at_ns):
            where = planar("odom", "base_link", odometry.x, odometry.y, odometry.yaw)
            rows += [where, (f"{FLOOR}/ellipse", self._ellipse(odometry))]
        if not self._whereabouts.known and self._due("frames/odom", _UNPLACED_EVERY, at_ns):
            rows.append(planar("map", "odom", 0.0, 0.0, 0.0))
        if not self._whereabouts.known:
            rows += self._draw_grid([(odometry.x, odometry.y)])
        self._moved |= self._trail.go_on(odometry.x, odometry.y, odometry.segment)
        return rows + self._draw_trail(at_ns)

    def _ellipse(self, odometry: Odometry) -> Any:
        """How sure odometry is, of its place and its heading."""
        xx, xy, _, yy, _, tt = odometry.covariance
        place = placed(ellipse(xx, xy, yy), odometry.x, odometry.y, 0.0)
        ways = [
            placed(way, odometry.x, odometry.y, odometry.yaw)
            for way in headings(tt, _HEADING * self._robot.footprint_radius)
        ]
        return rr.LineStrips2D([place, *ways], colors=[ELLIPSE], radii=[0.008])

    def _draw_truth(self, truth: TruePose, at_ns: int) -> list[Row]:
        rows = self._surroundings.on_truth(truth)
        if rows:
            rows += self._draw_grid([point for line in truth.walls for point in line])
        if not self._due("truth", _PLOT_EVERY, at_ns) or (apart := self._ghost.apart(truth)) is None:
            return rows
        strips = [placed(strip, *apart) for strip in self._outline]
        return [*rows, (f"{FLOOR}/truth", rr.LineStrips2D(strips, colors=[TRUTH], radii=[0.008], labels=["truth"]))]

    def _draw_map(self, walls: tuple[Wall, ...]) -> list[Row]:
        """The room goes, and its lines with it: until the robot was found, nobody knew where `odom` is in `map`."""
        if rows := self._surroundings.on_map(walls):
            self._spread = None
        return rows + self._draw_grid([point for wall in walls for point in (wall[:2], wall[2:])])

    def _draw_grid(self, places: list[Point]) -> list[Row]:
        """Lines a metre apart, from a metre beside all places that were heard of: the picture's axes."""
        if not places:
            return []
        xs, ys = [x for x, _ in places], [y for _, y in places]
        new = math.floor(min(xs)) - 1, math.floor(min(ys)) - 1, math.floor(max(xs)) + 2, math.floor(max(ys)) + 2
        old = self._spread or new
        spread = min(old[0], new[0]), min(old[1], new[1]), max(old[2], new[2]), max(old[3], new[3])
        if spread == self._spread:
            return []
        self._spread = spread
        lines, numbers = grid(*(max(-_FARTHEST, min(_FARTHEST, edge)) for edge in spread))
        at = rr.Points2D(list(numbers), labels=list(numbers.values()), colors=[GREY], radii=[0.0], show_labels=True)
        return [(GRID, rr.LineStrips2D(lines, colors=[LINES], radii=[0.004], draw_order=1.0)), (NUMBERS, at)]

    def _draw_trail(self, at_ns: int) -> list[Row]:
        rows = self._vision.draw_path() if self._due("visual", _TRAIL_EVERY, at_ns) else []
        if self._moved and self._due("trail", _TRAIL_EVERY, at_ns):
            self._moved = False
            rows.append((f"{FLOOR}/path", rr.LineStrips2D([self._trail.points], colors=[PATH], radii=[0.02])))
        return rows

    def _draw_evidence(self, now_ns: int) -> list[Row]:
        rows: list[Row] = []
        for name, each in self._evidence.items():
            state, why, evidence = each.shown(now_ns)
            level = "WARN" if state in ("fault", "blocked") else "INFO"
            rows += self._log(self._event_text.add(name, (level, ", ".join(filter(None, (state, why))))))
            before = self._drawn.get(name)
            if before == (state, evidence):
                continue
            self._drawn[name] = state, evidence
            path, colour, points = f"{_EVIDENCE}/{name}", EVIDENCE[state], _points(evidence)
            rows.append((path, _lines(evidence, colour)))
            if points or (before is not None and _points(before[1])):
                rows.append((path, rr.Points2D(points, colors=[colour], radii=[_THICK], draw_order=_ABOVE)))
        return rows

    def _say(self, lines: list[Line]) -> list[Row]:
        rows = self._log(lines)
        if (page := self._event_text.page) != self._page:
            self._page = page
            rows.append((GUARD, rr.TextDocument(page, media_type=rr.MediaType.MARKDOWN)))
        return rows

    def _log(self, lines: list[Line]) -> list[Row]:
        return [(LOG, rr.TextLog(text, level=level, color=LEVELS[level])) for level, text in lines]

    def _due(self, what: str, every: int, at_ns: int) -> bool:
        """Whether it is time to draw it again; a clock that was set back does not stop it."""
        last = self._last.get(what)
        if last is not None and 0 <= at_ns - last < every:
            return False
        self._last[what] = at_ns
        return True


def _lines(evidence: Evidence, colour: Colour) -> Any:
    """Outlines of the free floor, and thicker lines along what is seen, over the robot's rim."""
    seen = [strip for strip in evidence.seen if len(strip) > 1]
    radii = [0.008] * len(evidence.free) + [_THICK] * len(seen)
    return rr.LineStrips2D([*evidence.free, *seen], colors=[colour], radii=radii, draw_order=_ABOVE)


def _points(evidence: Evidence) -> list[Point]:
    return [strip[0] for strip in evidence.seen if len(strip) == 1]


def _styles(lines: list[Series]) -> list[Row]:
    peaks = AggregationPolicy.MinMax  # a mean of all points in a pixel would hide that a robot shakes
    return [
        (each.path, rr.SeriesLines(colors=[each.colour], names=[each.name], widths=[1.5], aggregation_policy=peaks))
        for each in lines
    ]


def _tilt(tilt: Tilt) -> Any:
    """Where the hand leans, in g: forward is up, left is left."""
    return rr.Arrows2D(
        vectors=[[-tilt.y / _GRAVITY, -tilt.x / _GRAVITY]], colors=[TILT if tilt.status == "running" else WHITE]
    )


def stock(name: str) -> RobotConfig:
    """A Giraff as it is sold, for desks that have no robot file."""
    return msgspec.convert(typed(_STOCK) | {"name": name}, RobotConfig)


_STOCK: Final = {
    "track_width": 0.470,
    "ticks_per_metre": 2002.0594,
    "max_wheel_speed": 0.6,
    "max_angular_speed": 1.57,
    "footprint_radius": 0.30,
    "sensors": {
        "front_left": {"index": 0, "x": 0.25, "y": 0.15, "yaw": 0.0},
        "front_right": {"index": 1, "x": 0.25, "y": -0.15, "yaw": 0.0},
        "rear": {"index": 2, "x": -0.25, "y": 0.0, "yaw": math.pi},
    },
}
