"""The process in front of a RoboClaw on the bench, with what it asks the controller, and what goes wrong in between."""

from typing import Final, NamedTuple

from giraff_schemas.boards import ROBOCLAW_BOARD
from giraff_schemas.wire import HelloFrame, HelloRequestFrame, ResetCause
from tests.firmware.bench import BaseBench
from tests.firmware.builds import open_board, with_fault

COMMAND, COUNTERS, STATUS, SET_TIMEOUT, GET_TIMEOUT, VERSION, BATTERY = 54, 78, 90, 14, 15, 21, 24
"""The commands of a RoboClaw."""
FULL: Final = 32767
PROVED_MS: Final = 100
"""Within which the controller has proved itself and the board has reported."""
# As in faults/roboclaw_line.c.
LOSES_REPLIES, SAYS_OTHERWISE, REPLIES_NOISE, KEEPS_OTHER_TIMEOUT, COUNTS_ANEW, HEARS_NOISE, DAMAGES_REPLIES = range(
    1, 8
)
_ASKED: Final = 16
_ENTRY: Final = 5
RUNS, IS_SUSPENDED, HANGS = range(3)
STOP: Final = (COMMAND, 0, 0)
MANY: Final = 255


class Request(NamedTuple):
    """One request to the controller, and the duty that each motor gets after it."""

    at_ms: int
    command: int
    left: int
    right: int

    @property
    def drives(self) -> bool:
        return self.command == COMMAND and (self.left, self.right) != (0, 0)


class RoboclawBench(BaseBench):
    """The board with its controller, from before they are powered on."""

    def __init__(self) -> None:
        super().__init__(open_board(ROBOCLAW_BOARD, with_fault("roboclaw_line", "model_on_byte", board="roboclaw")), 0)
        self.model.driver_volts = 24.0
        self.asked: list[Request] = []

    def run(self, milliseconds: int) -> None:
        registers = self.board.registers
        for _ in range(milliseconds):
            registers[_ASKED] = 0
            super().run(1)
            for place in range(registers[_ASKED]):
                begin = _ASKED + 1 + _ENTRY * place
                motors = bytes(registers[begin + 1 : begin + _ENTRY])
                left, right = (int.from_bytes(motors[at : at + 2], signed=True) for at in (0, 2))
                self.asked.append(Request(self.now_ms, registers[begin], left, right))

    def spoil(self, fault: int, command: int = 0, times: int = MANY, value: int = 0, place: int = 0) -> None:
        """Let a fault befall the next `times` requests, of this command alone if it is given."""
        self.board.registers[0:5] = bytes([fault, command, times, value, place])

    def until(self, command: int, within_ms: int = 300) -> Request:
        """Run until the controller is next asked this."""
        before = len(self.asked)
        for _ in range(within_ms):
            self.run(1)
            if found := [each for each in self.asked[before:] if each.command == command]:
                return found[0]
        raise AssertionError(f"{command} is not asked")

    def begin(self, left: int = 0, right: int = 0) -> None:
        """From power-on to driving."""
        self.run(PROVED_MS)
        self.configure()
        self.drive(0, 0)
        self.drive(left, right, 100)
        self.asked.clear()

    def keep_driving(self, left: int, right: int, milliseconds: int) -> None:
        """Ask for levels each 20 ms, as far as telemetry comes."""
        for _ in range(milliseconds):
            if self.now_ms % 20 == 0:
                self.send(self.drive_frame(left, right))
            self.run(1)

    def reset_after_ms(self, within_ms: int) -> int:
        """Drive on until the board is reset; return the ms that this took."""
        before, began = self.model.resets, self.now_ms
        while self.model.resets == before:
            assert self.now_ms - began < within_ms, "it is not reset"
            self.keep_driving(40, 40, 1)
        return self.now_ms - began

    def cause(self) -> ResetCause:
        """Ask the board, once it is there again, for the cause of its last reset."""
        self.run(PROVED_MS)
        self.send(HelloRequestFrame(seq=1))
        self.run(PROVED_MS)
        return ResetCause(self.last(HelloFrame).reset_cause)
