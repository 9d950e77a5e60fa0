"""Where a frame of the robot is in another, for a script, and the jump of `odom` that it may ask for."""

import threading
import time
from collections.abc import Callable
from typing import Final

import zenoh

from giraff_client import errors
from giraff_client.errors import RobotError, SilentError
from giraff_client.reading import require_finite
from giraff_core.kinematics import pose_history as found
from giraff_core.kinematics.frames import FrameTree
from giraff_core.kinematics.pose_history import Segment
from giraff_core.latest import is_fresh
from giraff_node.network.query_client import QueryClient
from giraff_node.network.replies import ask_all
from giraff_schemas.frames import MAP_FRAME, ODOM_FRAME, Transform
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.requests import OdomAnswer
from giraff_schemas.topics import POSE, Query, RequestT, frame_key

_ASK_EVERY: Final = 0.3  # s, while a frame is missing
_ANSWERED: Final = 0.5  # s in which whoever has frames tells of them
_FIRST_WITHIN: Final = 2.0  # s in which a robot that is there is found by all who ask it
_LOOK: Final = 0.01  # s
_ERRORS: Final[dict[type[found.FrameError], type[errors.FrameError]]] = {
    found.UnknownFrameError: errors.UnknownFrameError,
    found.UnconnectedError: errors.UnconnectedError,
    found.PastError: errors.PastError,
    found.FutureError: errors.FutureError,
    found.GapError: errors.GapError,
}
_LASTING: Final = (errors.PastError, errors.GapError)
_MISSING: Final = (errors.UnknownFrameError, errors.UnconnectedError)


class FrameFinder:
    """Hears where the robot is, and asks where its parts are: the first time, and again while one is missing.

    `odom`: raises RobotError where the newest of odometry says nothing of now. `silence`: why nothing is heard.
    """

    def __init__(self, odom: Callable[[], object], silence: Callable[[str], errors.RobotError]) -> None:
        self._odom, self._silence = odom, silence
        self._lock = threading.Lock()  # Zenoh's threads tell what they hear
        self._tree = FrameTree()
        self._segment = Segment()
        self._pose: MapPose | None = None
        self._posed = 0.0  # s of the monotonic clock
        self._session: zenoh.Session | None = None
        self._key = ""
        self._ask_at = self._first_until = 0.0  # s of the monotonic clock

    def begin(self, session: zenoh.Session, robot: str) -> None:
        """From here on there is somebody to ask."""
        self._session, self._key = session, frame_key(robot)
        self._first_until = time.monotonic() + _FIRST_WITHIN

    def on_odometry(self, odometry: Odometry) -> None:
        """Take where the robot is, as it arrives."""
        with self._lock:
            self._tree.on_odometry(odometry)
            self._segment.on_odometry(odometry)

    def hear_pose(self, pose: MapPose) -> None:
        """Take where the robot is on the map, as it arrives."""
        with self._lock:
            self._pose, self._posed = pose, time.monotonic()

    def lookup(self, target: str, source: str, at: RobotTime | None) -> Transform:
        """As `Robot.lookup`."""
        _require(target, source, at)
        until = max(self._first_until, time.monotonic() + _ANSWERED)
        while True:
            try:
                return self._found(target, source, at)
            except _MISSING:
                if time.monotonic() >= until:
                    raise
            time.sleep(_LOOK)

    def wait_for(self, target: str, source: str, at: RobotTime | None, timeout: float) -> Transform:
        """As `Robot.wait_for`."""
        _require(target, source, at)
        require_finite("wait_for", "s", timeout)
        until = time.monotonic() + timeout
        while True:
            try:
                return self._found(target, source, at)
            except _LASTING:
                raise
            except errors.RobotError:
                if time.monotonic() >= until or self._session is None:
                    raise
            time.sleep(_LOOK)

    def _found(self, target: str, source: str, at: RobotTime | None) -> Transform:
        with self._lock:
            unlocalized = self._place_odom()
        try:
            with self._lock:
                transform = self._tree.lookup(target, source, at)
        except found.FrameError as error:
            if unlocalized and MAP_FRAME in (target, source):
                raise errors.UnlocalizedError(unlocalized) from error
            self._ask()
            silence = self._silence(str(error))
            if isinstance(silence, errors.NoRobotError):  # it explains the silence of all its parts
                raise silence from error
            raise _ERRORS[type(error)](str(error)) from error
        if at is None and not transform.fixed:
            self._odom()
        return transform

    def _place_odom(self) -> str:
        """Put it where it is in `map`, or nowhere while that is not known; why it is not, if anything says so."""
        pose, old = self._pose, time.monotonic() - self._posed
        if pose is None:
            return ""
        if not is_fresh(POSE, old):
            fault = f"the pose on the map is silent for {old:.1f} s; check giraff_localization"
        elif pose.state != "localized":
            fault = (
                str(pose.reason) or f"it is not known where the robot is on the map ({pose.state}); `giraff localize`"
            )
        elif not self._segment.holds(pose.tick):
            fault = "the pose on the map is from before odometry was set or began anew; wait for localization"
        else:
            at = pose.odom
            told = Transform(
                parent=MAP_FRAME, child=ODOM_FRAME, x=at.x, y=at.y, yaw=at.yaw, fixed=False, tick=pose.tick
            )
            self._tree.on_transform(told)
            return ""
        self._tree.forget(ODOM_FRAME)
        return fault

    def _ask(self) -> None:
        now = time.monotonic()
        if self._session is None or now < self._ask_at:
            return
        self._ask_at = now + _ASK_EVERY
        ask_all(self._session, self._key, Transform, self._on_frame, _ANSWERED)

    def _on_frame(self, told: Transform) -> None:
        if told.fixed:  # where the robot is, odometry says all the time
            with self._lock:
                self._tree.on_transform(told)


class FrameReader:
    """What of `Robot` is about frames."""

    _frames: FrameFinder

    def lookup(self, target: str, source: str, at: RobotTime | None = None) -> Transform:
        """The pose of the frame `source` in `target`: m, and REP-103's roll, pitch and yaw, rad; order of names as tf2.

        `at`: a tick of the last 10 s, such as `odom().tick`; None: now. Where `odom` is in `map` is known of now alone,
        and taken for then, too: it is a correction, and no motion. Frames that are not known are asked for, which
        takes up to 0.5 s, or 2 s from the begin of the `with`. Raises FrameError, SilentError, LostRobotError,
        ValueError for what is no tick.
        """
        return self._frames.lookup(target, source, at)

    def wait_for(self, target: str, source: str, at: RobotTime | None = None, timeout: float = 2.0) -> Transform:
        """As `lookup`, once both frames and the moment are known; after `timeout` s it raises why they are not.

        What no waiting mends is raised at once: PastError and GapError.
        """
        return self._frames.wait_for(target, source, at, timeout)


def _require(target: object, source: object, at: object) -> None:
    if not all(isinstance(name, str) for name in (target, source)):
        raise ValueError(f"frames are called by name: {target!r} and {source!r} must be texts")
    if not (at is None or isinstance(at, RobotTime)):
        raise ValueError(f"at is {at!r}: it must be a tick of the robot, such as robot.odom().tick, or None for now")


def jump(
    session: zenoh.Session,
    robot: str,
    query: Query[RequestT, OdomAnswer],
    request: RequestT,
    patience: float,
    newest: Callable[[], tuple[Odometry | None, float]],
) -> None:
    """Ask odometry for it until it is done, and wait until the newest odometry that is heard is from after it.

    `newest`: what is heard of odometry, and when it was, s of the monotonic clock. Raises SilentError, RobotError.
    """
    asked = time.monotonic()
    asking = QueryClient(session, robot, query, request)
    answer = asking.wait(asked + patience)
    if answer is None:
        raise SilentError(
            f"{asking.fault or f'nobody answers {query.key}'}; check that giraff_odometry runs; "
            "on a secured network [network.access] says who may ask"
        )
    if not answer.done:
        raise RobotError(f"odometry refuses: {answer.reason}")
    until = time.monotonic() + patience
    while time.monotonic() < until:
        sample, heard = newest()
        if sample is not None and heard > asked and sample.jumps >= answer.jumps:
            return
        time.sleep(_LOOK)
    raise SilentError("odometry has done it, and odom is not heard since; check that giraff_base runs")
