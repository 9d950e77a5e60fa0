"""From pictures and the wheels' odometry to what a camera sees of the robot's motion. No I/O and no clock.

The picture's motion is found without the wheels. They have a veto: over the way since the key picture both must agree.
Where they do not, nobody can tell here which of the two is wrong: a dirty lens, something large that moves with the
robot, and wheels that slip look alike. So both are told, and neither is a measurement.
"""

import math
from collections import deque
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.pose import Pose
from giraff_core.picture.header import HeaderError, read_jpeg
from giraff_core.senses import Camera
from giraff_schemas.camera import Picture, VisualOdometry
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_vision import reasons
from giraff_vision.ground import Ground, PictureError
from giraff_vision.odometer import PictureMotion, VisualOdometer

_OFF_SHARE: Final = 0.08
"""m and rad for each of the wheels' way or turn by which both may differ: more than calibrations leave."""
_OFF_WAY: Final = 0.003
"""m by which they may differ besides: what a picture tells of a robot that stands."""
_OFF_TURN: Final = 0.01
"""rad, likewise."""
_ASIDE: Final = 0.05
"""m for each rad of turn: the floor that is seen lies ahead, so an error of the turn is one of the way to the side."""
_LATE: Final = 0.07
"""s. A camera may tell the moment of its exposure up to a picture's time too early: both differ while speed changes."""
_JITTER: Final = 0.003
"""s by which the moment of a picture is uncertain."""
_MOST_LATE: Final = 10.0
"""s from a tick to a picture that is exposed. Base ticks 50 times a second."""
DOUBT: Final = 0.02
"""m and rad by which they differ, from which later pictures are doubted, too, and people are told."""
_TRUSTED_AGAIN: Final = 0.05
"""m and rad by the wheels, over which both must agree after they did not."""
_DOUBTED_WAY: Final = 0.3
"""m and rad by the wheels after which the next key picture is taken while both disagree."""
_NOTHING: Final = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_KEPT: Final = 500
"""Samples of the wheels: 5 s of them, longer than a picture takes to come."""
_GAP: Final = 0.1
"""s by which a picture may be newer than the newest sample before it: the robot goes on meanwhile as it did then."""


def grey_of(jpeg: bytes, camera: Camera) -> NDArray[np.uint8]:
    """Return a picture of the camera in grey: (rows, columns). Raises PictureError where it is none.

    giraff_camera ends each picture with a marker, so one without it is torn.
    """
    try:
        header = read_jpeg(jpeg)
    except HeaderError as error:
        raise _unreadable(str(error)) from error
    if not header.fits(camera.width, camera.height):
        raise _unreadable(f"it says {header.width} x {header.height} px")
    if not header.is_ended:
        raise _unreadable("it is torn: its end is missing")
    try:
        pixels = cv2.imdecode(
            np.frombuffer(header.data, np.uint8), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
        )
    except cv2.error:
        pixels = None
    if pixels is None:
        raise _unreadable("it cannot be decoded")
    return np.asarray(pixels, np.uint8)


class _Travel(NamedTuple):
    """What was gone up to a picture."""

    path: Pose
    """In `base_link` of the first picture."""
    seen: float
    """m that were measured."""
    blind: float
    """m by the wheels."""


class Whereabouts(NamedTuple):
    """Where the wheels had the robot at the moment of a picture."""

    segment: tuple[int, str, int]
    """Between two of which this differs lies no motion."""
    pose: Pose
    """In `odom`."""
    speed: float
    """m/s."""
    turn: float
    """rad/s."""


class WheelPath:
    """What odometry has said in the last seconds."""

    def __init__(self) -> None:
        self._samples: deque[Odometry] = deque(maxlen=_KEPT)

    def add(self, sample: Odometry) -> None:
        """Take the next sample. An older one than the last is passed over."""
        last = self._samples[-1] if self._samples else None
        if last is not None and _segment(last) != _segment(sample):
            self._samples.clear()
        elif last is not None and sample.tick.robot_ns <= last.tick.robot_ns:
            return
        self._samples.append(sample)

    def at(self, tick: RobotTime | None, since_tick: float) -> Whereabouts | None:
        """Return where the wheels had the robot `since_tick` s after a tick; None: they do not tell."""
        if tick is None or not self._samples or tick.epoch != self._samples[-1].tick.epoch:
            return None
        moment = tick.robot_ns + round(since_tick * 1e9)
        before = next((each for each in reversed(self._samples) if each.tick.robot_ns <= moment), None)
        if before is None:
            return None
        seconds = (moment - before.tick.robot_ns) * 1e-9
        if seconds > _GAP:
            return None
        pose = Pose(before.x, before.y, before.yaw).moved(before.linear_x * seconds, before.angular_z * seconds)
        return Whereabouts(_segment(before), pose, before.linear_x, before.angular_z)


def _segment(sample: Odometry) -> tuple[int, str, int]:
    return sample.tick.epoch, *sample.segment


class VisionPolicy:
    """Follows one camera of one robot."""

    def __init__(self, camera: Camera) -> None:
        self._camera = camera
        self._odometer: VisualOdometer | None = None
        self._keys_before = 0
        """Key pictures of odometers before this one, for pictures of another size."""
        self._wheels = WheelPath()
        self._key_wheels: Whereabouts | None = None
        self._last_wheels: Whereabouts | None = None
        self._key_at = self._at = _Travel(Pose(0.0, 0.0, 0.0), 0.0, 0.0)
        self._is_doubted = False
        """Picture and wheels have disagreed, and not agreed over some way since then."""

    def on_odometry(self, odometry: Odometry) -> None:
        """Take the wheels' next word."""
        self._wheels.add(odometry)

    def on_picture(self, picture: Picture, grey: NDArray[np.uint8]) -> VisualOdometry:
        """Return what the next picture tells.

        `grey`: (rows, columns), of the camera's size or another of the same shape. Raises PictureError for another
        shape.
        """
        since_tick = picture.since_tick + (picture.exposure or 0.0) / 2.0
        if not 0.0 <= since_tick <= _MOST_LATE:
            what = f"a picture was exposed {since_tick:g} s after its tick, which no camera does"
            raise PictureError(Trouble(what, "find its sender with `giraff camera list`, and end it"))
        odometer = self._odometer_for(grey)
        here = self._wheels.at(picture.tick, since_tick)
        if here is not None and _between(self._key_wheels, here) is None:
            odometer.renew()  # the wheels have no word on the way since the key picture
        key_before = odometer.key
        seen = odometer.on_picture(odometer.ground.straightened(grey))
        wheels = _between(self._key_wheels, here)
        if seen.repeats and wheels is None and not seen.reason:
            seen = seen._replace(reason=reasons.UNSURE)  # only the wheels can tell which of several motions it is
        reason = seen.reason or self._veto(seen, wheels, here)
        if seen.motion is not None and not reason:
            way = math.hypot(seen.motion.x, seen.motion.y)
            begin = self._key_at
            self._at = _Travel(seen.motion.placed_in(begin.path), begin.seen + way, begin.blind)
        elif (rolled := _between(self._last_wheels, here)) is not None:
            way = math.hypot(rolled.x, rolled.y)
            self._at = _Travel(rolled.placed_in(self._at.path), self._at.seen, self._at.blind + way)
        self._last_wheels = here
        ground = odometer.ground
        told = VisualOdometry(
            camera=picture.camera,
            picture=picture.seq,
            tick=picture.tick,
            since_tick=since_tick,
            key=self._keys_before + seen.key,
            reason=reason,
            motion=seen.motion,
            covariance=_NOTHING if seen.reason else seen.covariance,
            wheels=wheels,
            path=self._at.path,
            seen_m=self._at.seen,
            blind_m=self._at.blind,
            width=ground.width,
            height=ground.height,
            tracked=ground.bent(seen.tracked),
            rejected=ground.bent(seen.rejected),
            ground=ground.outline,
        )
        if odometer.key != key_before or odometer.key < 0:
            self._key_wheels, self._key_at = here, self._at
        return told

    def _odometer_for(self, grey: NDArray[np.uint8]) -> VisualOdometer:
        height, width = grey.shape
        odometer = self._odometer
        if odometer is None or (odometer.ground.width, odometer.ground.height) != (width, height):
            ground = Ground(self._camera, width, height)
            if odometer is not None:
                self._keys_before += odometer.key + 1
                self._key_wheels = None
            odometer = self._odometer = VisualOdometer(ground)
        return odometer

    def _veto(self, seen: PictureMotion, wheels: Pose | None, here: Whereabouts | None) -> Trouble:
        """Why a motion that was seen is no measurement; NO_TROUBLE: it is one, or the wheels are silent."""
        if seen.motion is None:
            return NO_TROUBLE
        if wheels is None or here is None or self._key_wheels is None:
            return reasons.DOUBTED if self._is_doubted else NO_TROUBLE
        begin, off = self._key_wheels, seen.motion.seen_from(wheels)
        way, turn = math.hypot(wheels.x, wheels.y), abs(wheels.yaw)
        limit = _OFF_WAY + _OFF_SHARE * way + _ASIDE * turn + _late(begin.speed, here.speed)
        turn_limit = _OFF_TURN + _OFF_SHARE * turn + _late(begin.turn, here.turn)
        if math.hypot(off.x, off.y) > limit or abs(off.yaw) > turn_limit:
            self._is_doubted = self._is_doubted or is_large(off)
            if max(way, turn) > _DOUBTED_WAY and self._odometer is not None:
                self._odometer.renew()
            return reasons.DISAGREE
        if max(way, turn) > _TRUSTED_AGAIN:
            self._is_doubted = False
        return reasons.DOUBTED if self._is_doubted else NO_TROUBLE


def disagrees(told: VisualOdometry) -> bool:
    """Whether this is no measurement because the wheels disagree."""
    return told.reason == reasons.DISAGREE


def is_large(off: Pose) -> bool:
    """Whether picture and wheels differ by more than what a shadow or a late sample makes."""
    return max(math.hypot(off.x, off.y), abs(off.yaw)) > DOUBT


def _unreadable(why: str) -> PictureError:
    what = f"a picture is no JPEG that can be read: {why}"
    return PictureError(Trouble(what, "look at the camera's host: its pictures arrive damaged"))


def _late(begin: float, end: float) -> float:
    """Return m or rad that moments which are told wrongly make of a speed."""
    return _LATE * abs(end - begin) + _JITTER * max(abs(begin), abs(end))


def _between(begin: Whereabouts | None, end: Whereabouts | None) -> Pose | None:
    if begin is None or end is None or begin.segment != end.segment:
        return None
    return end.pose.seen_from(begin.pose)
