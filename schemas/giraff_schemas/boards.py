"""The boards that services speak with, each with its firmware's wire."""

from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

from giraff_schemas.wire import (
    BASE_BAUD,
    FRAME_CLASSES,
    JOYSTICK_BAUD,
    PROTOCOL_HASH,
    RANGER_BAUD,
    WHEELS_PERIOD_MS,
    BoardKind,
    Frame,
    HelloFrame,
    HelloRequestFrame,
)
from giraff_schemas.wires import balancer as balancer_wire
from giraff_schemas.wires import boards as other_boards
from giraff_schemas.wires import bumper as bumper_wire
from giraff_schemas.wires import transitions as transitions_wire


class BoardType(NamedTuple):
    """One board for which one firmware is built."""

    name: str
    """The folder in `firmware/boards`, and the word of `make -C firmware flash BOARD=`."""
    number: int
    """Tells it from other boards, in its `hello`."""
    baud: int
    protocol_hash: int = PROTOCOL_HASH
    frames: Mapping[int, type[Frame]] = FRAME_CLASSES
    """Frames on its line, by their type; `hello` and its request are among them."""
    report_ms: int = WHEELS_PERIOD_MS
    """ms. Time between two reports of a base board."""
    output_delay_us: int = 0
    """us. Longest time from a decision of the board to its motors: of a servo output, a frame and a pulse."""
    most_counts: int = 0
    """Edges a second of each wheel that it surely counts, with a tenth left for what overshoots; 0: more than any robot
    has that is built with it."""
    eeprom_bytes: int = 4096
    states_per_tick: int = 2
    """Quadrature states of an encoder for a tick: 2 where both edges of channel A count, 1 where those of B do, too."""
    is_process: bool = False
    """Its program is a process on the robot's computer, in front of a motor controller that others have made."""
    measures_battery: bool = True
    has_potentiometer: bool = False
    """It lowers what the board is asked for."""
    stops_after_s: float = 0.0
    """s from the newest byte until the motor controller of a process stops by itself; 0: the board is no process."""
    loop_hz: int = 0
    """Its motor controller holds speeds by its own loop: a level is so many counts within 1 / loop_hz s. 0: it is a
    share of the power."""
    chosen_in: str = ""
    """Table of the robot file whose `board` chooses among the boards with the same program; empty: it runs alone."""
    has_programmer: bool = False
    """It is written by a programmer on its ISP connector, not through its serial port."""
    has_own_pins: bool = False
    """Makers may wire it to other pins, for which they flash a folder of their own. It says the same number."""
    wiring_page: str = ""
    """Page by which a motor driver is wired to it, with a pull-down at each line; empty: its own circuit has them."""

    @property
    def tells_transitions(self) -> bool:
        """Return whether it can tell how both channels of its encoders change."""
        return transitions_wire.FRAME_CLASSES.keys() <= self.frames.keys()

    @property
    def unit(self) -> str:
        """Return the unit of systemd that runs its program. Empty: the board itself does."""
        return f"giraff-board@{self.name}" if self.is_process else ""

    def flash_advice(self, port: str) -> str:
        """Return how its program comes to run with the board on this serial port. `re` may stand before it."""
        if self.is_process:
            return f"start it: sudo systemctl restart {self.unit}"
        command = f"flash it: make -C firmware flash BOARD={self.name} PORT={'usb' if self.has_programmer else port}"
        return f"{command} (or BOARD= the folder of your own pins)" if self.has_own_pins else command


BASE_BOARD: Final = BoardType(
    "base",
    BoardKind.BASE,
    BASE_BAUD,
    frames=FRAME_CLASSES | transitions_wire.FRAME_CLASSES,
    eeprom_bytes=2048,
    chosen_in="[base.drive]",
    has_programmer=True,
)
JOYSTICK_BOARD: Final = BoardType("joystick", BoardKind.JOYSTICK, JOYSTICK_BAUD, eeprom_bytes=1024)
RANGER_BOARD: Final = BoardType(
    "ranger",
    BoardKind.RANGER,
    RANGER_BAUD,
    frames=FRAME_CLASSES | bumper_wire.FRAME_CLASSES,
    chosen_in="[ranger]",
)
NANO_RANGER_BOARD: Final = RANGER_BOARD._replace(
    name="nano_ranger", number=other_boards.NANO_RANGER_BOARD, eeprom_bytes=1024
)
ARDROS_BOARD: Final = BoardType(
    "ardros",
    other_boards.ARDROS_BOARD,
    BASE_BAUD,
    output_delay_us=22_000,
    most_counts=54_000,
    chosen_in="[base.drive]",
    has_potentiometer=True,
    wiring_page="docs/commissioning.md",
)
MEGA_L298N_BOARD: Final = BoardType(
    "mega_l298n",
    other_boards.MEGA_L298N_BOARD,
    BASE_BAUD,
    most_counts=54_000,
    chosen_in="[base.drive]",
    has_own_pins=True,
    wiring_page="docs/build-on-two-wheels.md",
)
MEGA_BTS7960_BOARD: Final = MEGA_L298N_BOARD._replace(name="mega_bts7960", number=other_boards.MEGA_BTS7960_BOARD)
ROBOCLAW_BOARD: Final = BoardType(
    "roboclaw",
    other_boards.ROBOCLAW_BOARD,
    BASE_BAUD,
    output_delay_us=65_000,
    eeprom_bytes=8,
    states_per_tick=1,
    is_process=True,
    stops_after_s=other_boards.ROBOCLAW_STOPS_AFTER_MS / 1000,
    chosen_in="[base.drive]",
)
ROS_ARDUINO_BRIDGE_BOARD: Final = ROBOCLAW_BOARD._replace(
    name="ros_arduino_bridge",
    number=other_boards.ROS_ARDUINO_BRIDGE_BOARD,
    output_delay_us=120_000,
    stops_after_s=other_boards.ROS_ARDUINO_BRIDGE_STOPS_AFTER_MS / 1000,
    loop_hz=30,
    measures_battery=False,
)
BALANCER_BOARD: Final = BoardType(
    "balancer",
    balancer_wire.BALANCER_BOARD,
    balancer_wire.BALANCER_BAUD,
    protocol_hash=balancer_wire.PROTOCOL_HASH,
    frames={frame.type: frame for frame in (HelloFrame, HelloRequestFrame)} | balancer_wire.FRAME_CLASSES,
)
BOARDS: Final = {BoardKind(board.number): board for board in (BASE_BOARD, JOYSTICK_BOARD, RANGER_BOARD)}
"""By the role that a board has for a stock robot. A robot file may choose another one for base and for ranger."""
ALL_BOARDS: Final = (
    *BOARDS.values(),
    BALANCER_BOARD,
    ARDROS_BOARD,
    MEGA_L298N_BOARD,
    MEGA_BTS7960_BOARD,
    NANO_RANGER_BOARD,
    ROBOCLAW_BOARD,
    ROS_ARDUINO_BRIDGE_BOARD,
)

BaseBoardName = Literal["base", "ardros", "mega_l298n", "mega_bts7960", "roboclaw", "ros_arduino_bridge"]
"""A word of `board` in [base.drive]."""


def boards_chosen_in(table: str) -> dict[str, BoardType]:
    """Return the boards among which `board` of this table of the robot file chooses, by their names."""
    return {board.name: board for board in ALL_BOARDS if board.chosen_in == table}
