"""The log of a service grows slowly, whoever causes its lines."""

import io
import json
from collections.abc import Callable
from typing import Any

import pytest

from giraff_node.process import logs
from giraff_node.process.health import HealthState
from giraff_schemas.trouble import Trouble

Write = Callable[[int, str], None]


class Rig:
    """A service's log whose clock stands unless the test moves it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 1000.0
        self._stderr = io.StringIO()
        monkeypatch.setattr("sys.stderr", self._stderr)
        monkeypatch.setattr(logs, "monotonic", lambda: self.now)
        self.log = logs.service_logger("limited")
        self.health = HealthState("limited", "1", self.log)
        self.by_writer: dict[str, Write] = {
            "a camera that is looked at": lambda _, text: self.log.info("%s looks at front", text),
            "a page": lambda number, text: self.log.info(f"{text}{number} drives"),  # noqa: G004  as pages have it
            "a notice that changes": lambda n, text: self.health.set_notice("write", Trouble(f"{n} bytes {text}")),
            "a key that comes and goes": lambda n, text: self.health.set_notice(
                f"decode {text}{n}", Trouble("rubbish")
            ),
        }

    def lines(self) -> list[dict[str, Any]]:
        """Since the last call."""
        written = self._stderr.getvalue().splitlines()
        self._stderr.seek(0)
        self._stderr.truncate()
        return [json.loads(line) for line in written]


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    return Rig(monkeypatch)


@pytest.mark.parametrize(
    "writer", ["a camera that is looked at", "a page", "a notice that changes", "a key that comes and goes"]
)
def test_a_flood_writes_little_and_hides_no_other_line(rig: Rig, writer: str) -> None:
    write = rig.by_writer[writer]
    for number in range(200):
        write(number, "x" * 60_000)
    rig.health.set_fault("board", Trouble("it is unplugged"))
    *flood, board = rig.lines()
    assert board["message"] == "it is unplugged"
    assert len(flood) == logs.BURST
    assert max(len(line["message"]) for line in flood) <= logs.LONGEST
    rig.now += logs.EVERY
    for number in range(200, 210):
        write(number, "short")
    [line] = rig.lines()
    assert line["message"].endswith("(180 more lines of this kind were left out)")


def test_an_error_is_always_whole(rig: Rig) -> None:
    for _ in range(100):
        rig.log.error("%s", "Traceback\n" * 1000)
    assert [line["message"].count("Traceback") for line in rig.lines()] == [1000] * 100
