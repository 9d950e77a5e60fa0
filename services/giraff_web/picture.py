"""What all pages are shown: the newest of each kind, as long as it says something of now. No I/O and no clock."""

import math
from collections import deque
from collections.abc import Sequence
from typing import Any, Final

from giraff_core.estop.request import BY_WORD
from giraff_core.latest import LatestSamples, is_fresh
from giraff_core.operator import Fault, what_stops
from giraff_core.robot import RobotConfig
from giraff_core.senses import PUBLISHERS, SENSE_OF, SENSED, Sense
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Attitude, DirectionLimit, EStop, GuardState, Odometry, Sample
from giraff_schemas.topics import ATTITUDE, BASE, BATTERY, ESTOP, GUARD, ODOM, POSE, SampleT, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.messages import Balance, CameraView, Direction, Latch, Lines, MapView, SensorView, State, moment
from giraff_web.policy import WebPolicy

_POINTS: Final = 2000
_APART: Final = 0.03  # m between two points of the path
_NEAR: Final = 0.2
"""m. Something this much farther than the robot's radius is near."""


class Picture:
    """Times are seconds of any one monotonic clock."""

    def __init__(self, robot: RobotConfig, *, is_open: bool) -> None:
        """`is_open`: of the network."""
        self._robot, self._is_open = robot, is_open
        self._fields = {name: _lines(robot.sensors[name].field(robot.footprint_radius)) for name in robot.sensor_types}
        self._sensed: dict[str, tuple[SensorView, float]] = {}
        """By sensor: its newest sample, and when it was heard."""
        self._latest = LatestSamples()
        self._trail: deque[tuple[float, float]] = deque(maxlen=_POINTS)
        self._segment: tuple[str, int] | None = None
        self._room_fits = True
        self._n = 0

    @property
    def trail(self) -> tuple[tuple[float, float], ...]:
        """The path so far, m in odom, oldest first."""
        return tuple(self._trail)

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take what the robot says."""
        if (kind := SENSE_OF.get(type(sample))) is not None:
            self._on_sensed(kind, sample, now)
            return
        self._latest.add(sample, now)
        if isinstance(sample, Odometry):
            self._go_on(sample)

    def state(self, policy: WebPolicy, stop_outcome: Trouble, now: float, camera: CameraView | None = None) -> State:
        """Return the next state. `stop_outcome`: of a stop or a release that was asked for here."""
        self._n += 1
        base, guard, estop = self._newest(BASE, now), self._newest(GUARD, now), self._newest(ESTOP, now)
        odom, battery = self._newest(ODOM, now), self._newest(BATTERY, now)
        attitude, place = self._newest(ATTITUDE, now), self._newest(POSE, now)
        operator, asked = policy.operator, policy.poll(now)
        age = now - operator.heard
        driver = policy.driver if operator.holds else None
        own = asked.trouble if isinstance(asked, Fault) else operator.refusal if operator.holder else NO_TROUBLE
        nobody_asks = base and guard and not (own or operator.holder)
        return State(
            n=self._n,
            tick=moment(None if operator.link_fault(now) else operator.tick),
            age=round(age, 3) if math.isfinite(age) else None,
            operator=operator.holder,
            device=driver.device if driver else "",
            page=driver.page if driver else 0,
            armed=base.armed if base else None,
            why=NO_TROUBLE if nobody_asks else what_stops(own, base, guard),
            stop=_latch(estop, is_open=self._is_open) if estop else None,
            stop_outcome=stop_outcome,
            directions=_directions(guard) if guard else None,
            evidence={sensor: self._evidence(sensor, now) for sensor in self._fields},
            pose=(round(odom.x, 4), round(odom.y, 4), round(odom.yaw, 4)) if odom else None,
            covariance=_place_covariance(odom) if odom else None,
            segment=f"{odom.instance}:{odom.jumps}" if odom else "",
            speed=(round(odom.linear_x, 3), round(odom.angular_z, 3)) if odom else None,
            path=round(odom.path, 3) if odom else None,
            battery=round(battery.voltage, 2) if battery else None,
            since_charge=battery.since_charge if battery else None,
            round_trip=base.round_trip if base else None,
            balance=self._balance(attitude, odom) if attitude else None,
            camera=camera,
            map=_map_view(place) if place else None,
            room_fits=self._room_fits,
        )

    def _go_on(self, odom: Odometry) -> None:
        if odom.segment != self._segment:
            self._room_fits = self._segment is None and odom.jumps == 0
            self._segment = odom.segment
            self._trail.clear()
        here = odom.x, odom.y
        if not self._trail or math.dist(self._trail[-1], here) >= _APART:
            self._trail.append(here)

    def _balance(self, attitude: Attitude, odom: Odometry | None) -> Balance:
        wheels = self._robot.kinematics.wheel_speeds(odom.linear_x, odom.angular_z) if odom else None
        return Balance(
            posture=attitude.posture,
            cause=attitude.cause,
            lean=round(attitude.lean, 5),
            accelerometer_lean=round(attitude.accelerometer_lean, 5),
            rate=round(attitude.rate, 4),
            torque=round(attitude.torque, 2),
            wheels=(round(wheels[0], 3), round(wheels[1], 3)) if wheels else None,
        )

    def _on_sensed(self, kind: type[Sense], sample: Any, now: float) -> None:
        """Draw a sample once, however often it is shown."""
        sense = self._robot.sensors.get(sample.sensor)
        if not isinstance(sense, kind):
            return
        text, nearest, trouble = sense.summary(sample)
        free, seen = map(_lines, sense.evidence(sample, self._robot.footprint_radius))
        state = "free" if nearest is None else "near" if nearest < self._robot.footprint_radius + _NEAR else "seen"
        if trouble:
            state, free = "fault", self._fields[sample.sensor]
        self._sensed[sample.sensor] = SensorView(state=state, text=text, reason=trouble, free=free, seen=seen), now

    def _evidence(self, sensor: str, now: float) -> SensorView:
        sense = type(self._robot.sensors[sensor])
        view, heard = self._sensed.get(sensor, (None, now))
        if view is not None and is_fresh(SENSED[sense], now - heard):
            return view
        what = "never heard" if view is None else f"silent for {now - heard:.0f} s"
        why = Trouble(what, f"check that giraff_{PUBLISHERS[sense.type_name()]} runs")
        return SensorView(state="fault", text="not heard", reason=why, free=self._fields[sensor])

    def _newest(self, topic: Topic[SampleT], now: float) -> SampleT | None:
        """None: what was heard last says nothing of now."""
        latest = self._latest.latest(topic, round(now * 1e9))
        return latest.sample if latest is not None and is_fresh(topic, latest.age) else None


def _lines(strips: Sequence[Sequence[tuple[float, float]]]) -> Lines:
    """Return them to the mm: a state is short."""
    return tuple(tuple((round(x, 3), round(y, 3)) for x, y in strip) for strip in strips)


def _place_covariance(of: Odometry | MapPose) -> tuple[float, float, float]:
    xx, xy, _, yy, _, _ = of.covariance
    return round(xx, 6), round(xy, 6), round(yy, 6)


def _map_view(place: MapPose) -> MapView:
    return MapView(
        state=place.state,
        map=place.map,
        pose=(round(place.x, 3), round(place.y, 3), round(place.yaw, 4)),
        covariance=_place_covariance(place),
        yaw_sd=round(place.standard_deviations[2], 4),
        why=place.reason,
        odom=(round(place.odom.x, 3), round(place.odom.y, 3), round(place.odom.yaw, 4)),
    )


def _latch(state: EStop, *, is_open: bool) -> Latch:
    return Latch(
        engaged=state.engaged,
        off=state.off,
        word=BY_WORD if is_open else "confirmed",
        by=state.by,
        reason=state.reason,
        id=str(state.id),
        engaged_ns=str(state.engaged_ns),
    )


def _directions(guard: GuardState) -> dict[str, Direction]:
    ways = {
        "forward": guard.forward,
        "backward": guard.backward,
        "turn_left": guard.turn_left,
        "turn_right": guard.turn_right,
    }
    return {way: _direction(verdict) for way, verdict in ways.items()}


def _direction(verdict: DirectionLimit) -> Direction:
    allowed = round(verdict.allowed, 3)
    return Direction(clearance=verdict.clearance, allowed=allowed, sensor=verdict.sensor, reason=verdict.reason)
