"""What the frames of the ranger board say about each sensor of the robot."""

from typing import Final

from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper, Ultrasonic
from giraff_core.tick_relay import TickRelay, tick_of
from giraff_schemas.boards import RANGER_BOARD, BoardType
from giraff_schemas.bumper import Bump
from giraff_schemas.frames import Transform
from giraff_schemas.messages import Range, RangeState, Tick
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import ECHO_US_PER_M, RangeFault, RangeFrame, TickFrame
from giraff_schemas.wire import RangeState as WireState
from giraff_schemas.wires.bumper import BumperFrame, BumperRequestFrame

LONGEST_ECHO_US: Final = 38_000
"""How long an HC-SR04 waits for an answer: a longer pulse is no echo."""

_ASK_AFTER: Final = 0.2  # s without a frame of the bumpers; the board sends one every 50 ms
_PATIENCE: Final = 5  # requests without an answer, until it is a fault

_STATES: Final[dict[int, RangeState]] = {WireState.ECHO: "echo", WireState.CLEAR: "clear"}

_FAULTS: Final[dict[int, Trouble]] = {
    RangeFault.NO_ECHO_PULSE: Trouble("does not answer", "check its power, its cable and its trigger and echo pins"),
    RangeFault.STUCK_HIGH: Trouble("holds its echo line high", "check the echo wire, then replace the sensor"),
    RangeFault.TOO_SHORT: Trouble(
        "sends pulses too short for any distance", "look for something on its face, then for a loose echo wire"
    ),
}


class RangerPolicy:
    """Turns the board's frames into samples."""

    def __init__(self, robot: RobotConfig, board: BoardType = RANGER_BOARD) -> None:
        self._sensors = robot.of(Ultrasonic)
        self._names = {pose.index: name for name, pose in self._sensors.items()}
        self._bumpers = robot.of(Bumper)
        self._ask_at = 0.0
        self._unanswered = 0
        self._tick_down = TickRelay()
        self._no_bumpers = Trouble(
            "the ranger board tells nothing of bumpers", f"flash it (make -C firmware flash BOARD={board.name})"
        )
        self.faults: dict[str, Trouble] = {}
        """What the newest frame of each sensor complains of; NO_TROUBLE when it does not."""

    def transforms(self) -> list[Transform]:
        """Where the sensors are on the robot."""
        return [pose.transform(name) for name, pose in self._sensors.items()]

    def on_tick(self, tick: Tick, now: float) -> TickFrame | None:
        """The robot's clock as it goes down to the board, which puts the last one into each frame."""
        return self._tick_down.frame(tick, now)

    def on_frame(self, frame: RangeFrame) -> Range | None:
        """The reading in `frame`; None when the robot file knows no such sensor."""
        name = self._names.get(frame.sensor)
        if name is None:
            known = ", ".join(f"{index} = {known}" for index, known in sorted(self._names.items())) or "none"
            self.faults[f"sensor {frame.sensor}"] = Trouble(
                f"the ranger board has a sensor {frame.sensor}, the robot file only {known}",
                "add it to [robot.sensors] with its pose",
            )
            return None
        sample = reading(name, frame, self._sensors[name].scale)
        self.faults[f"sensor {name}"] = sample.reason
        return sample

    def bumper_request(self, now: float) -> BumperRequestFrame | None:
        """Return what to ask of a board that has just said something; None while nothing is to be asked.

        A board tells nothing of its bumpers before it is asked, after each of its resets anew. `now`: monotonic, s.
        """
        if not self._bumpers or now < self._ask_at:
            return None
        self._ask_at = now + _ASK_AFTER
        self._unanswered += 1
        if self._unanswered > _PATIENCE:
            self.faults["bumpers"] = self._no_bumpers
        return BumperRequestFrame(seq=self._unanswered & 0xFFFF)

    def on_bumpers(self, frame: BumperFrame, now: float) -> list[Bump]:
        """Return what the frame says of each bumper of the robot file."""
        self._ask_at, self._unanswered = now + _ASK_AFTER, 0
        self.faults["bumpers"] = NO_TROUBLE
        return [
            Bump(sensor=name, pressed=bool(frame.open >> bumper.index & 1), tick=tick_of(frame))
            for name, bumper in self._bumpers.items()
        ]


def reading(name: str, frame: RangeFrame, scale: float) -> Range:
    """A frame of the sensor `name` in SI units. An echo of impossible length is a fault, never a distance.

    `scale`: of the robot file. The echo's length stays as the board has measured it.
    """
    fault = _fault(name, frame)
    state = "fault" if fault else _STATES[frame.state]
    return Range(
        sensor=name,
        state=state,
        range=frame.echo_us / ECHO_US_PER_M * scale if state == "echo" else None,
        echo_us=frame.echo_us,
        reason=fault,
        tick=tick_of(frame),
    )


def _fault(name: str, frame: RangeFrame) -> Trouble:
    """What is wrong with this reading."""
    if frame.state == WireState.FAULT and (fault := _FAULTS.get(frame.fault)):
        return Trouble(f"{name} {fault.what}", fault.remedy)
    if frame.state not in _STATES:
        return Trouble(
            f"{name} reports state {frame.state} with fault {frame.fault}, unknown here", "reflash the board"
        )
    if frame.state == WireState.ECHO and not 0 < frame.echo_us <= LONGEST_ECHO_US:
        return Trouble(f"{name} reports an echo of {frame.echo_us} us, which no distance gives", "reflash the board")
    return NO_TROUBLE
