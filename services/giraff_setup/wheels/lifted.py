"""A human beside two lifted wheels, without whom none of them turns."""

import signal
from types import FrameType
from typing import Final, Protocol

from giraff_setup.wheels.bench import Levels
from giraff_setup.wheels.wiring import DoubtError, Side

IN_DOUBT: Final = 1
NOT_BEGUN: Final = 2
"""Exit codes, beside those of any talk with a person."""

_WORD: Final = "lifted"


class Human(Protocol):
    """The person who watches the wheels."""

    def show(self, text: str) -> None: ...

    def ask(self, question: str) -> str:
        """Return the answer. Raises DoubtError when nobody is there any more."""
        ...


class Terminal:
    """A human in front of one."""

    def show(self, text: str) -> None:
        print(text, flush=True)

    def ask(self, question: str) -> str:
        try:
            return input(f"{question} ").strip().lower()
        except EOFError as error:
            raise DoubtError("nobody answers") from error


def ask_lifted(human: Human, port: str) -> bool:
    """Return whether the human says that the wheels may turn. From now on a signal to end raises KeyboardInterrupt."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    human.show(
        f"Base board on {port}. giraff_base must not run. Lift the robot so that both wheels turn freely,\n"
        "and keep the battery switch within reach. Ctrl-C stops at any time."
    )
    return human.ask(f'Type "{_WORD}" when both wheels turn freely:') == _WORD


def levels_of(side: Side, level: int) -> Levels:
    """Return levels that drive the wheel on one side alone."""
    return Levels(level, 0) if side == "left" else Levels(0, level)


def _interrupt(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt
