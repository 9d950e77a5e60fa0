"""What the viewer's own process keeps of what it was told."""

import itertools
import time
from collections.abc import Iterator

import psutil
import pytest
import rerun as rr

from giraff_tools.network.ports import free_port
from giraff_viewer.desk import TIMELINE, blueprint
from giraff_viewer.window import Window
from tests.support.waiting import wait


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
