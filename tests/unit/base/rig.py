"""Base's policy on a small board, in simulated robot time: the rig of these tests."""

import msgspec

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_base.estop import RELEASED, EStopLatch
from giraff_base.policy import BasePolicy
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import BaseState, GuardedCommand, RobotTime, Source, Wheels
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import (
    COMMAND_TIMEOUT_MS,
    ECHO_MAX_AGE_MS,
    PROTOCOL_HASH,
    WHEELS_PERIOD_MS,
    ConfigureFrame,
    DriveFrame,
    DriveState,
    EstopFrame,
    Frame,
    Latch,
    Refusal,
    SpeedFlag,
    SpeedFrame,
    WheelsFrame,
)
from tests.support import robots
from tests.support.robots import DRIVE

ROBOT = msgspec.structs.replace(robots.ROBOT, ticks_per_metre=2000.0)
CONFIG = robots.BASE
EPOCH = 7
STEP_NS = WHEELS_PERIOD_MS * 1_000_000
COMMAND_STEPS = 2
"""The guard speaks at 50 Hz, the board at 100 Hz."""

_STICTION = 0.01  # m/s


class Board:
    """What firmware/base does with frames, and wheels that follow their levels with inertia.

    Of a speed it makes the level that stands for it.
    """

    time_constant = 0.15
    """s."""

    def __init__(self, board_us: int = 0, robot: RobotConfig = ROBOT, max_level: int = DRIVE.max_level) -> None:
        self._speed_per_level = robot.max_wheel_speed / max_level
        self._ticks_per_metre = robot.ticks_per_metre
        self.boot_id = 1
        self.board_us = board_us
        self.ignores_configure = False
        self.is_deaf = False
        self.protocol_hash = PROTOCOL_HASH
        self.session = 0
        self.configured: list[ConfigureFrame] = []
        self.drive_state = DriveState.NOT_CONFIGURED
        self.latch = Latch.NONE
        self.battery_adc_counts = 800
        self.refusal = Refusal.NONE
        self.levels = (0, 0)
        self.speed_flags = SpeedFlag(0)
        self.speeds = [0.0, 0.0]
        self._ticks = [0.0, 0.0]
        self._last_seq: int | None = None
        self._time_left_ms = 0
        self._counts = {"accepted": 0, "refused": 0}
        self._sent = 0

    @property
    def board_ms(self) -> int:
        return self.board_us // 1000 & 0xFFFFFFFF

    def reset(self) -> None:
        """As after its watchdog: another boot, all forgotten but the latch."""
        self.boot_id += 1
        self.board_us = 0
        self.session = 0
        self.drive_state = DriveState.LATCHED if self.latch else DriveState.NOT_CONFIGURED
        self.refusal = Refusal.NONE
        self.levels = (0, 0)
        self._ticks = [0.0, 0.0]
        self._last_seq = None
        self._counts = {"accepted": 0, "refused": 0}

    def engage(self, latch: Latch) -> None:
        """Latch, by itself or by order."""
        self.latch, self.drive_state, self.levels = latch, DriveState.LATCHED, (0, 0)

    def hold(self, wheel: SpeedFlag) -> None:
        """Something holds a wheel."""
        self.drive_state, self.levels = DriveState.HELD, (0, 0)
        self.speed_flags = wheel

    def report(self) -> WheelsFrame:
        """Go on for one period; the report at its end."""
        self.board_us += WHEELS_PERIOD_MS * 1000
        if self.drive_state == DriveState.ACTIVE:
            self._time_left_ms -= WHEELS_PERIOD_MS
            if self._time_left_ms <= 0:
                self.drive_state, self.levels = DriveState.COMMAND_TIMEOUT, (0, 0)
        for wheel, level in enumerate(self.levels):
            wanted = level * self._speed_per_level
            self.speeds[wheel] += (wanted - self.speeds[wheel]) * WHEELS_PERIOD_MS / 1000 / self.time_constant
            if abs(self.speeds[wheel]) < _STICTION:
                self.speeds[wheel] = 0.0
            self._ticks[wheel] += self.speeds[wheel] * WHEELS_PERIOD_MS / 1000 * self._ticks_per_metre
        self._sent += 1
        return WheelsFrame(
            seq=self._sent & 0xFFFF,
            board_us=self.board_us & 0xFFFFFFFF,
            board_ms=self.board_ms,
            boot_id=self.boot_id,
            session=self.session,
            left_ticks=round(self._ticks[0]),
            right_ticks=round(self._ticks[1]),
            left_pwm_counts=self.levels[0],
            right_pwm_counts=self.levels[1],
            drive_state=self.drive_state,
            latch=self.latch,
            last_refusal=self.refusal,
            accepted=self._counts["accepted"],
            refused=self._counts["refused"],
            line_errors=0,
            battery_adc_counts=self.battery_adc_counts,
            left_um_s=round(self.speeds[0] * 1e6),
            right_um_s=round(self.speeds[1] * 1e6),
            speed_flags=self.speed_flags,
        )

    def receive(self, frame: Frame) -> None:
        if self.is_deaf:
            return
        if isinstance(frame, ConfigureFrame) and not self.ignores_configure:
            self.configured.append(frame)
            self._judge(self._configure(frame))
        elif isinstance(frame, DriveFrame | SpeedFrame):
            self._judge(self._drive(frame))
        elif isinstance(frame, EstopFrame):
            self._estop(frame)

    def _estop(self, frame: EstopFrame) -> None:
        if frame.engage:
            self.engage(self.latch or Latch.ESTOP)
        elif (
            (frame.boot_id, frame.session) == (self.boot_id, self.session)
            and (self.board_ms - frame.board_ms) & 0xFFFFFFFF <= ECHO_MAX_AGE_MS
            and self.latch
        ):
            self.latch, self.drive_state = Latch.NONE, DriveState.AWAITING_ZERO

    def _judge(self, refusal: Refusal) -> None:
        self._counts["accepted" if refusal == Refusal.NONE else "refused"] += 1
        if refusal != Refusal.NONE:
            self.refusal = refusal

    def _configure(self, frame: ConfigureFrame) -> Refusal:
        if frame.protocol_hash != self.protocol_hash or not frame.session:
            return Refusal.PROTOCOL
        if frame.boot_id != self.boot_id:
            return Refusal.BOOT_ID
        self.session, self._last_seq = frame.session, None
        self.drive_state, self.levels = DriveState.LATCHED if self.latch else DriveState.AWAITING_ZERO, (0, 0)
        return Refusal.NONE

    def _drive(self, frame: DriveFrame | SpeedFrame) -> Refusal:
        asked, configured = demand(frame), self.configured[-1] if self.configured else None
        if frame.boot_id != self.boot_id:
            return Refusal.BOOT_ID
        if (self.board_ms - frame.board_ms) & 0xFFFFFFFF > ECHO_MAX_AGE_MS:
            return Refusal.STALE
        if not self.session or configured is None:
            return Refusal.NOT_CONFIGURED
        if self._last_seq is not None and not 0 < (frame.seq - self._last_seq) & 0xFFFF < 0x8000:
            return Refusal.SEQUENCE
        by_speed = isinstance(frame, SpeedFrame)
        if max(map(abs, asked)) > (configured.speed_max_um_s if by_speed else configured.level_max):
            return Refusal.LEVEL
        self._last_seq = frame.seq
        if self.latch:
            return Refusal.LATCHED
        opens = asked == (0, 0) and (by_speed or self.drive_state != DriveState.HELD)
        if not opens and self.drive_state != DriveState.ACTIVE:
            return Refusal.AWAITING_ZERO
        left, right = asked
        scale = 1e-6 / self._speed_per_level if by_speed else 1
        self.drive_state, self.levels = DriveState.ACTIVE, (round(left * scale), round(right * scale))
        self._time_left_ms = COMMAND_TIMEOUT_MS
        return Refusal.NONE


def demand(frame: DriveFrame | SpeedFrame) -> tuple[int, int]:
    """What the left and the right wheel are asked for: levels, or µm/s."""
    if isinstance(frame, SpeedFrame):
        return frame.left_um_s, frame.right_um_s
    return frame.left_level, frame.right_level


class Sent(msgspec.Struct, frozen=True):
    """A drive or speed frame with what base went by."""

    robot_ns: int
    report: WheelsFrame
    frame: DriveFrame | SpeedFrame
    state: BaseState

    @property
    def levels(self) -> tuple[int, int]:
        assert isinstance(self.frame, DriveFrame)
        return demand(self.frame)

    @property
    def um_s(self) -> tuple[int, int]:
        assert isinstance(self.frame, SpeedFrame)
        return demand(self.frame)

    @property
    def moves(self) -> bool:
        return demand(self.frame) != (0, 0)


class Rig:
    """Base, its board, a guard and the hand behind it. The attributes are what the next commands say."""

    def __init__(self, config: BaseConfig = CONFIG, drive: WheelsConfig = DRIVE, latch: EStopLatch = RELEASED) -> None:
        self.live = Live(msgspec.structs.replace(config, drive=drive))
        self.base = BasePolicy(self.live, ROBOT, latch)
        self.board = Board(board_us=0xFFFFFFFF - 2_000_000)  # its clock wraps in the course of a test
        self.robot_ns = 1_000_000_000_000
        self.sent: list[Sent] = []
        self.samples: list[Wheels] = []
        self.connected = True
        """The board's frames arrive, and base's arrive there."""
        self.guard = "guard-1"
        self.guard_speaks = True
        self.guard_age = 0.005
        self.operator = "operator-1"
        self.lease_counter = 5
        self.operator_age = 0.03
        self.operator_tick: RobotTime | None = None
        """When given, the hand's newest moment, however old it gets."""
        self.range_age: float | None = 0.1
        self.epoch = EPOCH
        self.linear = self.angular = 0.0
        self.source: Source = "hand"
        self.faults = 0
        self.hand_neutral: bool | None = None
        """None: as the twist says."""
        self.reason = ""
        self._seqs: dict[str, int] = {}
        self._steps = 0
        self.base.on_link_opened(session=99)

    @property
    def now(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=self.robot_ns)

    def ago(self, seconds: float | None) -> RobotTime | None:
        """The moment this long ago, in the hand's epoch."""
        if seconds is None:
            return None
        return RobotTime(epoch=self.epoch, robot_ns=self.robot_ns - round(seconds * 1e9))

    def command(self) -> GuardedCommand:
        """What the guard says now."""
        self._seqs[self.guard] = self._seqs.get(self.guard, -1) + 1
        neutral = self.linear == 0.0 and self.angular == 0.0 and self.source == "hand"
        return GuardedCommand(
            seq=self._seqs[self.guard],
            instance=self.guard,
            linear_x=self.linear,
            angular_z=self.angular,
            guard_tick=self.ago(self.guard_age),
            operator=self.operator,
            lease_counter=self.lease_counter,
            operator_tick=self.operator_tick or self.ago(self.operator_age),
            range_tick=self.ago(self.range_age) if self.linear else None,
            source=self.source,
            faults=self.faults,
            hand_neutral=neutral if self.hand_neutral is None else self.hand_neutral,
            reason=Trouble(self.reason),
        )

    def say(self, command: GuardedCommand) -> None:
        self.base.on_command(command, self.now)

    def step(self) -> Frame | None:
        """10 ms: a command of the guard when it is time, a report of the board, base's answer."""
        self.robot_ns += STEP_NS
        self._steps += 1
        report = self.board.report()
        if self.guard_speaks and self._steps % COMMAND_STEPS == 0:
            self.say(self.command())
        if not self.connected:
            return None
        self.samples += [each for each in self.base.on_frames([report], self.now) if isinstance(each, Wheels)]
        frame = self.base.next_frame(self.now)
        if frame is not None:
            self.board.receive(frame)
        if isinstance(frame, DriveFrame | SpeedFrame):
            self.sent.append(Sent(self.robot_ns, report, frame, self.base.state()))
        return frame

    def run(self, seconds: float) -> list[Sent]:
        """Go on for a while; the drive or speed frames of it."""
        before = len(self.sent)
        for _ in range(round(seconds * 1e9) // STEP_NS):
            self.step()
        return self.sent[before:]

    def tilt(self, linear: float, angular: float = 0.0) -> None:
        self.linear, self.angular = linear, angular

    def freeze(self, seconds: float) -> list[Sent]:
        """Go on while the hand's newest command is repeated: its tick gets no younger."""
        self.operator_tick = self.ago(self.operator_age)
        sent = self.run(seconds)
        self.operator_tick = None
        return sent

    def arm(self) -> None:
        """Hold the hand level until the robot is armed."""
        self.tilt(0.0)
        self.run(0.6)
        assert self.base.state().armed, self.base.state().reason

    def drive(self, linear: float = 0.6, angular: float = 0.0) -> list[Sent]:
        """Arm, and drive until the speed is reached."""
        self.arm()
        self.tilt(linear, angular)
        sent = self.run(1.5)
        assert sent[-1].moves, sent[-1].state.reason
        return sent


def moving(sent: list[Sent]) -> list[Sent]:
    return [each for each in sent if each.moves]
