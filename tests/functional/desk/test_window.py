"""The viewer's own process: what it keeps, and what it can draw."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
import rerun as rr

from giraff_cli.watcher import free_port
from giraff_schemas.messages import EStop
from giraff_schemas.topics import ESTOP
from giraff_viewer.desk import TIMELINE, blueprint
from giraff_viewer.glyphs import ALPHABET
from giraff_viewer.scene import stock
from giraff_viewer.show import Show
from giraff_viewer.window import Window
from tests.support.waiting import wait

pytestmark = pytest.mark.usefixtures("able_to_draw")


@pytest.fixture(scope="module")
def window() -> Iterator[Window]:
    """A viewer that may keep little."""
    with Window(free_port(), "100MB", headless=True) as opened:
        yield opened


def test_what_the_viewer_forgets_goes_back_to_the_machine(window: Window) -> None:
    stream = rr.RecordingStream("giraff words")
    stream.connect_grpc(window.url, default_blueprint=blueprint(live=True))
    viewer = psutil.Process(window.pid)
    seconds = itertools.count(1)

    def log(text: str) -> float:
        second = float(next(seconds))
        stream.set_time(TIMELINE, timestamp=second)
        stream.log("words", rr.TextDocument(text))
        stream.flush()
        return second

    def grown() -> int:
        """Bytes, within half a second."""
        began = viewer.memory_info().rss
        log("")
        time.sleep(0.5)
        return viewer.memory_info().rss - began

    def megabytes_more() -> float:
        log("")  # it forgets while it draws, and it draws while it hears
        return (viewer.memory_info().rss - before) / 1e6

    first = log("")
    wait(lambda: window.shows(first), 30.0, what="the viewer has nothing")
    wait(lambda: grown() < 1_000_000, 30.0, what="the viewer is still opening")  # its window takes a hundred MB
    before = viewer.memory_info().rss
    last = max(log("x" * 1_000_000) for _ in range(250))
    wait(lambda: window.shows(last), 60.0, what="the viewer does not have everything")
    wait(
        lambda: megabytes_more() < 125.0,
        20.0,
        what=lambda: f"of 250 MB that were sent, with a limit of 100 MB, it keeps {megabytes_more():.0f} MB",
        every=0.1,
    )
    stream.disconnect()


def test_every_character_that_is_let_through_can_be_drawn(window: Window, tmp_path: Path) -> None:
    show = Show(stock("sim-test"), live=True)
    show.to_window(window.url)
    words = " ".join("".join(ALPHABET[number : number + 20]) for number in range(0, len(ALPHABET), 20))
    show.hear(ESTOP, EStop(engaged=True, id=1, by="\U0001f408 |", reason=words), time.time_ns())
    show.close()
    window.picture(tmp_path / "words.png", show.newest)
    assert window.is_open()
