"""The joystick: tilt in the hand to `cmd_vel/<operator>`."""

from __future__ import annotations

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.timer import PromptTimer, Timer
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_schemas.boards import JOYSTICK_BOARD
from giraff_schemas.topics import LEASE, OPERATOR_CMD_VEL, TICK, TILT
from giraff_schemas.wire import TiltFrame


class Joystick:
    """Reads the joystick board, `lease`, and `tick`, which it hands down to the board; writes `tilt` and commands.

    It gives a command at once on each reading, and at its rate while there are none.
    """

    def __init__(
        self, io: IO, config: JoystickConfig, robot: RobotConfig, policy: type[JoystickPolicy] = JoystickPolicy
    ) -> None:
        self._io = io
        self._policy = policy(config, robot, io.instance)
        io.on_reconfigured = self._policy.reconfigure
        self.link = io.board(config.port, JOYSTICK_BOARD)
        self._clock, self._leases = io.inbox(TICK, limit=1), io.inbox(LEASE, limit=10)
        self._tilts = io.publisher(TILT)
        self._commands = io.publisher(OPERATOR_CMD_VEL.at(config.operator))
        self._timer = PromptTimer(OPERATOR_CMD_VEL.rate_hz)
        self.timers: tuple[Timer, ...] = (self._timer,)

    def turn(self, now: float) -> None:
        policy, link = self._policy, self.link
        for frame in link.poll(now):
            if isinstance(frame, TiltFrame):
                self._tilts.put(policy.on_frame(frame, now))
                self._timer.hurry("tilt", now)
        for lease in self._leases.take():
            policy.on_lease(lease)
        for tick in self._clock.take():
            if (down := policy.on_tick(tick, now)) is not None:
                link.send(down)
        if self._timer.due(now):
            command = policy.command(now)
            self._commands.put(command)
            if (lost := policy.lost(now)) is not None:
                self._tilts.put(lost)
            self._io.set_fault("board", link.fault)
            self._io.set_fault("sensor", policy.sensor_fault)
            self._io.set_notice("hand", "" if policy.sensor_fault else command.reason)
            self._io.set_notice("lease", policy.refusal)
            self._io.set_notice("rank", policy.rank_notice)

    def end(self) -> None:
        """Let go of the robot."""
        self._commands.put(self._policy.final_command())
