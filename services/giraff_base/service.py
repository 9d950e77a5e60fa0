"""The robot's clock, and the only writer to the base board."""

from typing import Final

from giraff_base.config import BaseConfig
from giraff_base.estop_server import EStopServer
from giraff_base.policy import BasePolicy
from giraff_core.estop.latch import LATCH_FILE, LatchSaver, load_latch
from giraff_core.io import IO
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera
from giraff_core.timer import Timer
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.topics import BASE, BATTERY, CMD_VEL, ESTOP, ESTOP_ENGAGE, ESTOP_RESET, TICK, VISUAL_ODOM
from giraff_schemas.trouble import NO_TROUBLE

_TAKEN_ALONG: Final = 0.25 / TICK.rate_hz
"""s. A tick that is due within this time goes out with the board's report. One wake then serves both."""


class Base:
    """Reads the base board, `cmd_vel` and what is asked of the emergency stop; writes `tick`, `wheels` and its state.

    Where the robot has a camera it reads `visual_odom`, too, but waits for none.

    A report of the board makes a turn due, and so does a command: the frame that drives answers either.
    """

    def __init__(self, io: IO, config: BaseConfig, robot: RobotConfig, policy: type[BasePolicy] = BasePolicy) -> None:
        self._io = io
        self._epoch = io.token()
        self._policy = policy(Live(config), robot, load_latch(io.store, io.token()), io.lost_parameters)
        io.on_reconfigured = self._policy.on_reconfigured
        self._server = EStopServer(self._policy, LatchSaver(io.store.writer(LATCH_FILE)), io.instance)
        self.link = io.board(config.port, config.drive.board_type)
        self._opened = 0
        self._commands = io.inbox(CMD_VEL)
        self._seen = io.inbox(VISUAL_ODOM, wakes=False) if robot.of(Camera) else None
        self._engages, self._resets = io.requests(ESTOP_ENGAGE), io.requests(ESTOP_RESET)
        self._ticks = io.publisher(TICK)
        self._samples = {topic.schema: io.publisher(topic) for topic in self._policy.topics}
        self._states = _States(io, self._policy)
        self._tick_timer = Timer(TICK.rate_hz)
        self.timers = (self._tick_timer,)

    def turn(self, now: float) -> None:
        policy, link = self._policy, self.link
        frames = link.poll(now)
        if is_due := self._tick_timer.due(now, _TAKEN_ALONG if frames else 0.0):
            self._ticks.put(Tick(epoch=self._epoch, robot_ns=self._io.robot_ns()))
        if link.opened != self._opened:
            self._opened = link.opened
            policy.on_link_opened(session=self._io.token())
        if link.fault:
            policy.on_link_lost(link.fault)
        robot_time = RobotTime(epoch=self._epoch, robot_ns=self._io.robot_ns())
        for command in self._commands.pop_all():
            policy.on_command(command, robot_time)
        for sample in policy.on_frames(frames, robot_time):
            self._samples[type(sample)].put(sample)
        if self._seen is not None:
            for told in self._seen.pop_all():
                policy.on_camera(told, robot_time)
        self._server.on_requests(self._engages.pop_all(), self._resets.pop_all(), robot_time)
        if (frame := policy.next_frame(robot_time)) is not None:
            link.send(frame)
        self._server.turn(robot_time)
        self._states.put(now)
        if is_due:
            self._tell_what_is_wrong()

    def end(self) -> None:
        """Nothing is left to say: the board stops by itself."""

    def _tell_what_is_wrong(self) -> None:
        self._io.set_fault("board", self.link.fault)
        self._io.set_fault("estop", self._server.fault)
        for name, trouble in self._policy.faults.items():  # of the robot, and of a second guard
            self._io.set_notice(name, trouble)


class _States:
    """Publishes what base says of itself: at its rates, and at once what changes."""

    def __init__(self, io: IO, policy: BasePolicy) -> None:
        self._policy = policy
        self._base, self._estop, self._battery = io.publisher(BASE), io.publisher(ESTOP), io.publisher(BATTERY)
        self._base_timer, self._estop_timer, self._battery_timer = (
            Timer(row.rate_hz) for row in (BASE, ESTOP, BATTERY)
        )
        self._reason = NO_TROUBLE
        self._told = policy.estop()

    def put(self, now: float) -> None:
        """`now`: monotonic, s."""
        policy = self._policy
        if self._base_timer.due(now) or policy.reason != self._reason:
            self._reason = policy.reason
            self._base.put(policy.state())
        estop = policy.estop()
        # At once also where it was engaged and is engaged again: who has asked waits for this word.
        if self._estop_timer.due(now) or estop != self._told:
            self._told = estop
            self._estop.put(estop)
        if self._battery_timer.due(now) and (battery := policy.battery()) is not None:
            self._battery.put(battery)
