"""What a person types in another terminal while a run goes on. Every line can be pasted, in any folder."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from giraff_core.network import NetworkConfig
from giraff_tools.network.interfaces import Interface

_VERBS = (("drive",), ("stop",), ("why",), ("watch",))


def _camera_verb() -> tuple[str, ...]:
    """Return the verb that shows what the camera sees: in a window where its library is here, else as a file."""
    return ("camera", "view") if find_spec("rerun") else ("camera", "view", "--save", "look.jpg")


@dataclass(frozen=True, kw_only=True)
class Invitation:
    """Command lines that find the robot of the run."""

    giraff: Sequence[str]
    """The words that call it."""
    robot: str
    """Empty: it is found without its name, being the simulation of this host, and alone where it is called."""
    connect: str
    """Address at which the run is called; empty: it is found without."""
    robot_file: Path | None
    """The file that leads to its network; None: no file is needed."""

    def command(self, *verb: str) -> str:
        """A command line."""
        file = [f"GIRAFF_CONFIG={self.robot_file}"] if self.robot_file else []
        robot = ["--robot", self.robot] if self.robot else []
        connect = ["--connect", self.connect] if self.connect else []
        return shlex.join([*file, *self.giraff, *verb, *robot, *connect])

    @property
    def hints(self) -> list[str]:
        """What must be at hand at any moment."""
        return [f"drive it: {self.command('drive')}", f"stop it:  {self.command('stop')}"]

    @property
    def how_to_see(self) -> str:
        """How to see what its camera sees."""
        return f"see by it: {self.command(*_camera_verb())}"

    def lines(self, *, camera: bool = False) -> list[str]:
        """Drive it, stop it, ask it why it does not move, watch it; with a camera, see by it."""
        return [self.command(*verb) for verb in (*_VERBS, *([_camera_verb()] if camera else []))]


def invite(
    giraff: Sequence[str],
    robot: str,
    network: NetworkConfig,
    robot_file: Path,
    *,
    interfaces: Sequence[Interface],
    is_only_here: bool,
) -> Invitation:
    """`network`: of the run, with its rendezvous; `robot_file`: its own; `interfaces`: of this host.

    `is_only_here`: it has the name of this host's simulation, no other robot is heard, and no GIRAFF_CONFIG names one.
    """
    is_plain = network.mode == "lan" and not network.session_file
    # With addresses of its own, a command does not ask by multicast.
    is_announced = is_plain and not (network.local or network.connect) and any(each.multicast for each in interfaces)
    # A session file leads to the network alone, and a run has a rendezvous of its own, which no other file names.
    connect = "" if is_announced or network.session_file else network.rendezvous
    return Invitation(
        giraff=giraff,
        robot="" if is_only_here and is_plain else robot,
        connect=connect,
        robot_file=None if is_plain else robot_file,
    )
