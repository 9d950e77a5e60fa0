"""The other end of the control socket."""

import os
import socket
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

import msgspec

from giraff_schemas.wire import Wiring
from giraff_sim.control import messages
from giraff_sim.control.messages import BoardName, State, Surfaces, Wheel
from giraff_sim.record import MotorWindow
from giraff_sim.truth import Truth
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.sonar import SonarFault


class SimulatorError(Exception):
    """The simulator refused a request, or is gone. The message says why."""


class SimulatorClient:
    """Typed requests, one at a time. Each returns when it is done; most answer with the simulated us."""

    def __init__(self, path: Path, timeout: float = 5.0) -> None:
        """Connect; `timeout` (s, of the wall's time) bounds this and every request."""
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(timeout)
        self._path = path
        try:
            self._socket.connect(os.fspath(path))
        except OSError as error:
            self._socket.close()
            raise SimulatorError(f"no simulator at {path}: {error}") from error
        self._lines = self._socket.makefile("rb")
        self._decoder = msgspec.json.Decoder(messages.Reply)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Hang up; the simulator goes on."""
        self._lines.close()
        self._socket.close()

    def now(self) -> int:
        """The simulated time, us."""
        return self._ask(messages.Now()).now_us

    def state(self) -> State:
        """The simulated robot as it truly is."""
        state = self._ask(messages.GetState()).state
        if state is None:
            raise SimulatorError(f"{self._path}: a reply without the state")
        return state

    def room(self) -> Surfaces:
        """What stands in the room."""
        room = self._ask(messages.GetRoom()).room
        if room is None:
            raise SimulatorError(f"{self._path}: a reply without the room")
        return room

    def truth(self) -> Truth:
        """How this robot differs from what its file says."""
        truth = self._ask(messages.GetTruth()).truth
        if truth is None:
            raise SimulatorError(f"{self._path}: a reply without the truth")
        return truth

    def record(self, since_us: int = 0, until_us: int | None = None) -> MotorWindow:
        """The black box's verdict on a window of simulated time."""
        record = self._ask(messages.GetRecord(since_us=since_us, until_us=until_us)).record
        if record is None:
            raise SimulatorError(f"{self._path}: a reply without the record")
        return record

    def tilt(self, x: float, y: float, z: float = 9.81) -> int:
        """Hold the joystick so that its sensor feels this, m/s^2."""
        return self._ask(messages.Tilt(x=x, y=y, z=z)).now_us

    def hand(self, hand: str) -> int:
        """Give the joystick to "demo", "still", "laid_down", "shaken", "dropped", or a tilt script, from now on."""
        return self._ask(messages.SetHand(hand=hand)).now_us

    def button(self, *, pressed: bool) -> int:
        """Press the joystick's button, or let it go."""
        return self._ask(messages.Button(pressed=pressed)).now_us

    def place(self, x: float, y: float, yaw: float = 0.0) -> int:
        """Set the robot down elsewhere, at rest. m, rad."""
        return self._ask(messages.Place(x=x, y=y, yaw=yaw)).now_us

    def add_wall(self, name: str, points: list[tuple[float, float]], *, closed: bool = False) -> int:
        """Put up a wall."""
        return self._ask(messages.AddWall(name=name, points=points, closed=closed)).now_us

    def remove_wall(self, name: str) -> int:
        """Take away every wall and post of a name."""
        return self._ask(messages.RemoveWall(name=name)).now_us

    def fail_bno055(self, fault: Bno055Fault) -> int:
        """Break the joystick's sensor, or mend it."""
        return self._ask(messages.FailBno055(fault=fault)).now_us

    def fail_sonar(self, number: int, fault: SonarFault, wild_share: float = 0.0) -> int:
        """Break a sonar, or mend it; `wild_share` of its pings, for WILD_SOME."""
        return self._ask(messages.FailSonar(number=number, fault=fault, wild_share=wild_share)).now_us

    def cut_bumper(self, number: int, *, cut: bool) -> int:
        """Cut a bumper's wire, or mend it."""
        return self._ask(messages.CutBumper(number=number, cut=cut)).now_us

    def block_wheel(self, wheel: Wheel, *, blocked: bool) -> int:
        """Hold a wheel so that it does not turn, or let it go."""
        return self._ask(messages.BlockWheel(wheel=wheel, blocked=blocked)).now_us

    def brake_wheel(self, wheel: Wheel, brake: float) -> int:
        """Hold a wheel back by so many m/s² at its rim, as a hand does; 0 lets it go."""
        return self._ask(messages.BrakeWheel(wheel=wheel, brake=brake)).now_us

    def rewire(self, wiring: Wiring) -> int:
        """Rewire motors and encoders so that `configure.wiring` must be this."""
        return self._ask(messages.Rewire(wiring=int(wiring))).now_us

    def cut_encoder(self, wheel: Wheel, *, cut: bool) -> int:
        """Cut a wheel encoder's wires, or mend them."""
        return self._ask(messages.CutEncoder(wheel=wheel, cut=cut)).now_us

    def slip_encoder(self, wheel: Wheel, lost_share: float) -> int:
        """Let a wheel's encoder lose this share of its counts; 0 mends it."""
        return self._ask(messages.SlipEncoder(wheel=wheel, lost_share=lost_share)).now_us

    def flicker_encoder(self, wheel: Wheel, *, flickers: bool) -> int:
        """Let a wheel's encoder count to and fro while the wheel rests, or mend it."""
        return self._ask(messages.FlickerEncoder(wheel=wheel, flickers=flickers)).now_us

    def cut_signal(self, wheel: Wheel, *, cut: bool) -> int:
        """Pull off the wire from a wheel's servo output to the motor driver, or put it back."""
        return self._ask(messages.CutSignal(wheel=wheel, cut=cut)).now_us

    def battery(self, volts: float) -> int:
        """Set the battery's voltage with nothing connected."""
        return self._ask(messages.Battery(volts=volts)).now_us

    def push(self, impulse: float, height: float = 0.8) -> int:
        """Push a robot that balances by so many N s, forward positive, so many m above its axle."""
        return self._ask(messages.Push(impulse=impulse, height=height)).now_us

    def unplug(self, board: BoardName) -> int:
        """Pull a board's serial cable."""
        return self._ask(messages.Unplug(board=board)).now_us

    def plug(self, board: BoardName) -> int:
        """Plug it in again."""
        return self._ask(messages.Plug(board=board)).now_us

    def reset(
        self, board: BoardName, cause: Literal["power_on", "external", "brown_out", "watchdog"] = "external"
    ) -> int:
        """Reset a board's processor."""
        return self._ask(messages.Reset(board=board, cause=cause)).now_us

    def _ask(self, request: messages.Request) -> messages.Reply:
        try:
            self._socket.sendall(msgspec.json.encode(request) + b"\n")
            line = self._lines.readline()
        except OSError as error:
            raise SimulatorError(f"the simulator at {self._path} does not answer: {error}") from error
        if not line:
            raise SimulatorError(f"the simulator at {self._path} has ended")
        reply = self._decoder.decode(line)
        if not reply.ok:
            raise SimulatorError(reply.error)
        return reply
