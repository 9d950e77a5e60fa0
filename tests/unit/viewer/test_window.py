"""How a picture of the viewer is taken."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from giraff_viewer import window
from giraff_viewer.window import Window
from tests.support.one_process import Clock


class Drawn(Window):
    """Shows everything from its second frame on, and pop-ups for its first twenty."""

    def __init__(self) -> None:
        self.frames = 0

    def shows(self, newest: float) -> bool:
        del newest
        self.frames += 1
        return self.frames > 1

    def _client(self) -> Any:
        return SimpleNamespace(save_screenshot=lambda path: Path(path).write_bytes(b"%d" % self.frames))


def test_a_picture_waits_until_the_viewers_pop_ups_have_been_drawn(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """They go by frames. A short recording is shown long before, and its plots were covered."""
    monkeypatch.setattr(window, "time", Clock())
    Drawn().picture(tmp_path / "view.png", 0.0)
    assert int((tmp_path / "view.png").read_bytes()) > 20
