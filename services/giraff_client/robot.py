"""`Robot`: reads what the robot says and drives it, from a script of one's own."""

import contextlib
import logging
import secrets
import socket
import threading
import time
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any, Final, Self

import zenoh

from giraff_client.camera import CameraFinder, CameraReader
from giraff_client.errors import NoRobotError, RobotError, SilentError
from giraff_client.frames import FrameFinder, FrameReader, jump
from giraff_client.motion import Motions
from giraff_client.policy import OperatorPolicy
from giraff_client.reading import Heard, States, blockage, has_heard_each_sensor, require_finite
from giraff_core.latest import is_fresh
from giraff_core.motion.result import NO_WAY, MotionResult
from giraff_core.timer import Timer
from giraff_node import Publisher
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.consent import NoRobotError as UnknownRobotError
from giraff_node.network.discovery import (
    CORRECT_IT,
    Target,
    find_robot,
    not_found_text,
    others,
    require_consent,
    resolve_target,
    stand_in,
)
from giraff_node.network.hand import open_hand
from giraff_node.network.reach import find_silent, silence_text
from giraff_node.network.session import NobodyError, close_session, open_session
from giraff_node.network.tcp_options import set_tcp_options
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import DriveCommand, Odometry, Sample
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.services import CLIENT, SCRIPT
from giraff_schemas.topics import (
    ODOM,
    ODOM_RESET,
    ODOM_SET_POSE,
    OPERATOR_CMD_VEL,
    TICK,
    Query,
    RequestT,
    SampleT,
    Topic,
    alive_key,
    key_of,
    require_chunk,
)

_PERIOD: Final = 1.0 / OPERATOR_CMD_VEL.rate_hz  # s
_FIRST_WITHIN: Final = 2.0  # s in which a robot that is there has said everything once
_LOOK: Final = 0.01  # s
_TOLD: Final = 0.1  # s within which all others know, too, that nobody has the robot
_TUNE_HZ: Final = 2.0  # a laptop on Wi-Fi comes back with another link
_TWIST: Final = "m/s and rad/s"
_OUTSIDE: Final = "not on the network; use it as `with Robot() as robot:`"


class Robot(Motions, States, FrameReader, CameraReader):
    """One robot, for one script and one thread. Nothing is asked of the robot before the first `arm` or `drive`.

    `name`: of the robot; else GIRAFF_ROBOT_NAME, else the robot file's, else the only one on the network.
    `connect`: hosts like "192.168.1.20", where multicast does not reach. `operator`: the name under which the script
    drives. `patience`: s to find the robot, and to get it armed.
    """

    def __init__(
        self,
        name: str | None = None,
        *,
        connect: str | Sequence[str] = (),
        operator: str = SCRIPT,
        patience: float = 5.0,
    ) -> None:
        self.name = name or ""
        """Of the robot; once it is found, if it was not given."""
        self._given = name
        self._connect = [connect] if isinstance(connect, str) else connect
        self._operator = require_chunk(operator)
        self._patience = patience
        self._instance = secrets.token_hex(8)
        self._policy = OperatorPolicy(operator, self._instance)
        self._lock = threading.Lock()  # Zenoh's threads tell the policy what they hear
        self._newest: dict[str, tuple[Sample, float]] = {}  # by key, with when it was heard
        self._first_until = 0.0  # s of the monotonic clock; what was not heard by then is not waited for
        self._declared: list[Any] = []  # a subscriber that nobody references ends
        self._session: zenoh.Session | None = None
        self._commands: Publisher[DriveCommand] | None = None
        self._has_armed = False
        self._is_named = False
        self._tuning = Timer(_TUNE_HZ)
        self._frames = FrameFinder(self.odom, self._silence)
        self._cameras = CameraFinder(lambda: self._newest.get(TICK.key), self._silence)

    def __enter__(self) -> Self:
        """Raises NoRobotError."""
        try:
            self._open()
        except BaseException:
            self._close()
            raise
        self._first_until = time.monotonic() + _FIRST_WITHIN
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop, and let others drive."""
        if self._commands is not None:
            self._commands.put(self._policy.final_command())
        self._close()

    def odom(self) -> Odometry:
        """Pose in `odom` and twist, newest first heard within the last second. Raises SilentError, LostRobotError."""
        return self._fresh(ODOM, "check that giraff_odometry and giraff_base run")

    def reset_odom(self) -> None:
        """Let odometry begin anew here: pose, path and covariance are 0, also of the next `odom`. It moves nothing.

        As of `set_odom`.
        """
        self._jump(ODOM_RESET, OdomReset(by=self._by, id=secrets.randbits(63)))

    def set_odom(self, x: float, y: float, yaw: float, position_sd: float = 0.0, yaw_sd: float = 0.0) -> None:
        """Let odometry take the robot to be there: m and rad, in `odom`; the path goes on. It moves nothing.

        `position_sd` (m, on either axis) and `yaw_sd` (rad): standard deviations of how sure that is. It returns when
        odometry has confirmed it and the next `odom` is from after it, which takes some hundredths of a second. A
        robot that nobody has named takes a typed yes, as of `arm`. Raises SilentError without odometry, RobotError
        where it refuses, ValueError for what is no pose.
        """
        given = (x, y, yaw, position_sd, yaw_sd)
        require_finite("set_odom", "m, m, rad, m and rad", *given)
        x, y, yaw, position_sd, yaw_sd = map(float, given)  # True is a number, too, and no number in a message
        request = OdomSetPose(
            by=self._by, id=secrets.randbits(63), x=x, y=y, yaw=yaw, position_sd=position_sd, yaw_sd=yaw_sd
        )
        self._jump(ODOM_SET_POSE, request)

    def arm(self) -> None:
        """Ask for the lease and hold still until the robot is armed, about half a second. The first `drive` does so.

        After an emergency stop, or when another operator had the robot, only this makes it drive again: nothing moves
        because somebody has reset something. A robot that nobody has named takes a typed yes, unless it is the
        simulation of this host. Raises RobotError.
        """
        self._require_consent()
        deadline = time.monotonic() + self._patience
        with self._lock:
            self._policy.begin(time.monotonic())
        while time.monotonic() < deadline:
            with self._lock:
                command = self._policy.step(time.monotonic())
            if command is None:
                self._has_armed = True
                return
            self._put(command)
        raise self._policy.gave_up()

    def drive(self, linear_x: float, angular_z: float) -> None:
        """Drive so from now on, m/s and rad/s (left positive), and return after 1/50 s.

        It holds for 0.4 s, fading out in the second half: a script that does not call again in time, because it
        hangs, waits or has died, stops the robot. The guard may let through less, or nothing, see `check_way`; it is
        no error. Raises RobotError where the robot does not obey this script any more, ValueError for what is no
        number.
        """
        require_finite("drive", _TWIST, linear_x, angular_z)
        if not self._has_armed:
            self.arm()
        with self._lock:
            command = self._policy.drive(linear_x, angular_z, time.monotonic())
        self._put(command)

    def check_way(self, linear_x: float, angular_z: float) -> None:
        """Raise BlockedError where the guard lets nothing through that way now, m/s and rad/s; it moves nothing.

        A call of its own, because only the script knows whether a blocked way is its end: a patrol waits until the
        person has passed, and needs no error for it. It permits nothing, either: the guard judges each `drive`. It
        judges straight ways and turns; of a curve, whether its way straight on is free. Raises SilentError without
        the guard, LostRobotError, ValueError for what is no number.
        """
        require_finite("check_way", _TWIST, linear_x, angular_z)
        if blocked := blockage(self.guard(), linear_x, angular_z):
            raise blocked

    def stop(self) -> None:
        """Stand still now. The robot stays armed for a second; see `rest`."""
        if self._has_armed:
            with contextlib.suppress(RobotError):  # whoever is not obeyed drives nothing, either
                self.drive(0.0, 0.0)

    def rest(self, seconds: float) -> None:
        """Stand still for so long, and stay armed: what a script that drives uses in the place of `time.sleep`."""
        until = time.monotonic() + seconds
        self.drive(0.0, 0.0)
        while time.monotonic() < until:
            self.drive(0.0, 0.0)

    def _open(self) -> None:
        """Join the robot's network, and hear it. Raises NoRobotError."""
        try:
            way = resolve_target(self._given, self._connect)
        except UnknownRobotError as error:
            raise NoRobotError(str(error)) from error
        except ConfigError as error:
            raise NoRobotError(f"{error}; {CORRECT_IT}") from error
        if silent := find_silent(self._connect):
            raise NoRobotError(f"connect: {silence_text(silent)}; check the address, and that the robot is on")
        try:
            if way.warning:
                logging.getLogger(__package__).warning("not everything of robot file and environment: %s", way.warning)
            self._session = self._find_door(way)
            self._is_named = bool(way.robot)
            self.name = stand_in(self._session, way) or find_robot(self._session, way.filed, self._patience)
            self._session = open_hand(way.network, self.name, self._session)
            self._listen(self._session)
            self._cameras.begin(self._session, way.network, self.name, self._by)
        except (UnknownRobotError, ConfigError) as error:
            raise NoRobotError(str(error)) from error
        except zenoh.ZError as error:
            raise NoRobotError(
                f"no Zenoh session: {error}; check the table [network] of the robot file, and `connect`"
            ) from error

    def _find_door(self, way: Target) -> zenoh.Session:
        """A session of which only the finding is asked. Raises UnknownRobotError, ConfigError, `zenoh.ZError`."""
        until = time.monotonic() + self._patience
        while True:
            try:
                return open_session(way.network, way.robot or "*", "client")
            except NobodyError as error:
                if time.monotonic() >= until:
                    raise UnknownRobotError(not_found_text(way.robot, ())) from error
                time.sleep(_PERIOD)

    @property
    def _by(self) -> str:
        """Whom to name to those who ask who it was."""
        return f"{self._operator}@{socket.gethostname()}"

    def _require_consent(self) -> zenoh.Session:
        """The session, once it is known that this robot is meant. Raises NoRobotError."""
        if self._session is None:
            raise NoRobotError(_OUTSIDE)
        if not self._is_named:
            try:
                require_consent(self._session, self.name, f'Robot("{self.name}")')
            except UnknownRobotError as error:
                raise NoRobotError(str(error)) from error
            self._is_named = True
        return self._session

    def _jump(self, query: Query[RequestT, OdomAnswer], request: RequestT) -> None:
        def newest() -> tuple[Odometry | None, float]:
            sample, heard = self._newest.get(ODOM.key, (None, 0.0))
            return sample if isinstance(sample, Odometry) else None, heard

        try:
            jump(self._require_consent(), self.name, query, request, self._patience, newest)
        except SilentError as error:
            raise self._silence(str(error)) from error

    def _begin_motion(self) -> tuple[zenoh.Session, str, str, float]:
        session = self._require_consent()
        if self._commands is not None and self._policy.holds:  # motion takes the robot from nobody, from this script
            self._commands.put(self._policy.final_command())  # neither, whose lease ends a second after this
            self._wait_for(lambda: not self._policy.holds, self._patience)
            time.sleep(_TOLD)
        return session, self.name, self._by, self._patience

    def _end_motion(self, result: MotionResult) -> None:
        """Nothing was taken from the script where only the way or the time was at an end: `drive` may arm again."""
        if result.begun:
            self._has_armed = result.outcome not in ("arrived", "blocked", "time_limit", *NO_WAY)

    def _put(self, command: DriveCommand) -> None:
        """Publish, and wait until the next one may come."""
        if self._commands is None:
            if self._session is None:
                raise NoRobotError(_OUTSIDE)
            topic = OPERATOR_CMD_VEL.at(self._operator)
            self._commands = Publisher(self._session, self.name, topic, self._instance)
        if self._tuning.due(time.monotonic()):
            set_tcp_options()
        self._commands.put(command)
        time.sleep(_PERIOD)

    def _fresh(self, topic: Topic[SampleT], remedy: str) -> SampleT:
        self._wait_for_first(lambda: topic.key in self._newest)
        sample, heard = self._newest.get(topic.key, (None, 0.0))
        if sample is None:
            raise self._silence(f"{topic.key} was never heard; {remedy}")
        if not is_fresh(topic, old := time.monotonic() - heard):
            raise self._silence(f"{topic.key} is silent for {old:.1f} s; {remedy}")
        assert isinstance(sample, topic.schema)  # noqa: S101  it was decoded as one
        return sample

    def _hear_each(self, topic: Topic[Any]) -> tuple[Heard, float]:
        self._wait_for_first(lambda: has_heard_each_sensor(topic, self._newest.copy()))
        return self._newest.copy(), time.monotonic()

    def _silence(self, text: str) -> RobotError:
        """Why nothing is heard: a robot that is lost explains the silence of all its parts."""
        if self._session is None:
            return NoRobotError(_OUTSIDE)
        with self._lock:
            lost = self._policy.lost(time.monotonic())
        return lost or SilentError(text)

    def _wait_for_first(self, holds: Callable[[], bool]) -> None:
        """What a script never heard delays it once: one that waits while it drives stops the robot."""
        self._wait_for(holds, self._first_until - time.monotonic())

    def _wait_for(self, holds: Callable[[], bool], seconds: float) -> bool:
        until = time.monotonic() + seconds
        while not holds() and time.monotonic() < until:
            time.sleep(_LOOK)
        return holds()

    def _listen(self, session: zenoh.Session) -> None:
        """Hear all that a script may ask for, until the robot's clock has come. Raises UnknownRobotError."""
        for topic in CLIENT.subscribes:
            self._declared.append(session.declare_subscriber(key_of(self.name, topic), self._hearer(topic)))
        token = alive_key(self.name, CLIENT.name, self._instance)
        self._declared.append(session.liveliness().declare_token(token))
        if not self._wait_for(lambda: TICK.key in self._newest, self._patience):
            raise UnknownRobotError(not_found_text(self.name, ()) + others(session, self.name))
        self._frames.begin(session, self.name)

    def _hearer(self, topic: Topic[Any]) -> Callable[[zenoh.Sample], None]:
        prefix = key_of(self.name, TICK).removesuffix(TICK.key)

        def on_sample(received: zenoh.Sample) -> None:
            key = str(received.key_expr)
            try:
                sample = decode(topic, key, bytes(received.payload), str(received.encoding))
            except DecodeError as error:
                logging.getLogger(__package__).debug("%s", error)
                return
            now = time.monotonic()
            with self._lock:  # first, so that whoever sees a tick has a policy that knows of it
                self._policy.on_sample(sample, now)
            if isinstance(sample, Odometry):
                self._frames.on_odometry(sample)
            if isinstance(sample, MapPose):
                self._frames.hear_pose(sample)
            self._newest[key.removeprefix(prefix)] = sample, now

        return on_sample

    def _close(self) -> None:
        """Another `with` of the same object is another operator: its commands are counted anew."""
        self._cameras.close()
        self._declared.clear()
        self._newest.clear()
        self._commands, self._has_armed = None, False
        self._instance = secrets.token_hex(8)
        self._policy = OperatorPolicy(self._operator, self._instance)
        self._frames = FrameFinder(self.odom, self._silence)
        self._cameras = CameraFinder(lambda: self._newest.get(TICK.key), self._silence)
        if self._session is not None:
            close_session(self._session)
            self._session = None
