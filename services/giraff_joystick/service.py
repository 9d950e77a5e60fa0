"""The joystick: tilt in the hand to `cmd_vel/<operator>`."""

from giraff_core.io import IO
from giraff_core.live import Live
from giraff_core.operator import Fault, OperatorService, Wish
from giraff_core.robot import RobotConfig
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_schemas.boards import JOYSTICK_BOARD
from giraff_schemas.messages import Tick
from giraff_schemas.topics import TILT
from giraff_schemas.wire import TiltFrame


class Joystick(OperatorService):
    """Reads the joystick board, `lease`, and `tick`, which it hands down to the board; writes `tilt` and commands.

    It gives a command at once on each reading, and at its rate while there are none.
    """

    def __init__(
        self, io: IO, config: JoystickConfig, robot: RobotConfig, policy: type[JoystickPolicy] = JoystickPolicy
    ) -> None:
        self._io = io
        live = Live(config)
        self._policy = policy(live, robot, io.instance)
        io.on_reconfigured = live.replace
        self._board = io.board(config.port, JOYSTICK_BOARD)
        super().__init__(io, self._policy)
        self.link = self._board
        self._tilts = io.publisher(TILT)

    def turn(self, now: float) -> None:
        for frame in self._board.poll(now):
            if isinstance(frame, TiltFrame):
                self._tilts.put(self._policy.on_frame(frame, now))
                self.timer.fire_now("tilt", now)
        super().turn(now)

    def on_tick(self, tick: Tick, now: float) -> None:
        super().on_tick(tick, now)
        if (down := self._policy.on_tick(tick, now)) is not None:
            self._board.send(down)

    def on_said(self, asked: Wish | Fault, now: float) -> None:
        if (lost := self._policy.lost(now)) is not None:
            self._tilts.put(lost)
        self._io.set_fault("board", self._board.fault)
        self._io.set_fault("sensor", self._policy.sensor_fault)
        super().on_said(asked, now)
