"""The table `[ranger]` of the robot file. Names, numbers and poses of the sensors are in `[robot]`."""

from typing import ClassVar, Literal

import msgspec

from giraff_core.tuning import Tuning
from giraff_schemas.boards import RANGER_BOARD, BoardType, boards_chosen_in


class RangerConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which board measures the ranges, and where it is."""

    LIVE: ClassVar = Tuning.READ_ONLY

    port: str = "/dev/giraff-ranger"
    """Path of the board's serial port."""
    board: Literal["ranger", "nano_ranger"] = "ranger"
    """An Arduino Mega, or an Arduino Nano (`nano_ranger`)."""

    def __post_init__(self) -> None:
        if not self.port:
            raise ValueError("port is empty: give the path of the ranger board's serial port")

    @property
    def board_type(self) -> BoardType:
        """The board that the ranger speaks with, and that the simulator runs."""
        return boards_chosen_in(RANGER_BOARD.chosen_in)[self.board]
