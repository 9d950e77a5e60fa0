"""The viewer's own process: what it can draw."""

import time
from pathlib import Path

from giraff_schemas.messages import EStop
from giraff_schemas.topics import ESTOP
from giraff_schemas.trouble import Trouble
from giraff_tools.network.ports import free_port
from giraff_viewer.event_text import ALPHABET
from giraff_viewer.scene import stock
from giraff_viewer.show import Show
from giraff_viewer.window import Window


def test_every_character_that_is_let_through_can_be_drawn(tmp_path: Path) -> None:
    with Window(free_port(), "100MB", headless=True) as window:
        show = Show(stock("sim-test"), live=True)
        show.to_window(window.url)
        words = " ".join("".join(ALPHABET[number : number + 20]) for number in range(0, len(ALPHABET), 20))
        show.on_sample(ESTOP, EStop(engaged=True, id=1, by="\U0001f408 |", reason=Trouble(words)), time.time_ns())
        show.close()
        window.picture(tmp_path / "words.png", show.newest)
        assert window.is_open()
