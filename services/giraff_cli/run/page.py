"""The page of a run: what its service is told of the room, and where it is to be opened."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_sim.world.room import Room
from giraff_tools.terminal.addresses import CodeScreen, with_loopback
from giraff_web.messages import Room as Walls

ROOM_FILE: Final = "room.json"
CODE_KEY: Final = "c"
_ANNOUNCED: Final = "to drive, open "
_NO_NETWORK: Final = "this computer is in no network. Connect it to the phone's network, and start the run again."
_KEPT_OFF: Final = "--local, or the address that [web] names, keeps it off the network. Start the run without."


class _Line(msgspec.Struct):
    """What counts of a line of the service's log."""

    message: str


def walls_of(room: Room) -> Walls:
    """What stands in a room, in the frame of odometry, which begins where the robot does."""
    start = Pose(*room.start)
    walls = tuple(tuple(start.sees(x, y) for x, y in line) for line in room.outlines())
    return Walls(walls=walls, map=room.name, start=room.start)


def write_room(room: Room, path: Path) -> None:
    """As giraff_web reads it."""
    path.write_bytes(msgspec.json.encode(walls_of(room)))


class Page:
    """The addresses that its service tells in its log, one a line; those of one moment share their token."""

    def __init__(self, log: Path, *, everywhere: bool) -> None:
        """`log`: which may not be there yet. `everywhere`: the port is open at all of this host's addresses."""
        self._log = log
        self._everywhere = everywhere
        self.addresses: tuple[str, ...] = ()
        """The newest; empty: none so far."""
        self._shows_code = False

    def on_keys(self, typed: str) -> None:
        """Show the code from its key on, until any key is typed. `typed`: since the last call."""
        if typed:
            self._shows_code = not self._shows_code and CODE_KEY in typed

    @property
    def code(self) -> CodeScreen | None:
        """Return the code that a person looks at instead of the run. None: nobody asked for it."""
        why_here = _NO_NETWORK if self._everywhere else _KEPT_OFF
        return CodeScreen(self.addresses, why_here) if self._shows_code else None

    def update(self) -> bool:
        """Whether there are new ones since the last call."""
        told = list(self._told())
        newest = tuple(each for each in told if each.partition("#")[2] == told[-1].partition("#")[2])
        newest = with_loopback(newest) if self._everywhere else newest
        is_news = newest != self.addresses
        self.addresses = newest
        return is_news

    def _told(self) -> Iterator[str]:
        try:
            whole, _, _ = self._log.read_bytes().rpartition(b"\n")
        except FileNotFoundError:
            return
        for line in whole.splitlines():
            with contextlib.suppress(msgspec.MsgspecError):  # Python's own words, of a fault
                message = msgspec.json.decode(line, type=_Line).message
                if message.startswith(_ANNOUNCED):
                    yield message.removeprefix(_ANNOUNCED)
