"""Where a service is asked for its parameters: what a disk that is slow, and who asks without end, do to it."""

import logging
import threading
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_core.io import Inbox
from giraff_core.parameters.server import ParameterServer
from giraff_core.parameters.table import Parameters
from giraff_guard.config import GuardConfig
from giraff_node.process.state import Folder
from giraff_schemas.params import ParamSave
from tests.support.robots import ROBOT
from tests.support.waiting import wait
from tests.unit.node.asked import Asked


class Desk:
    """Of a guard whose margin was set to 0.5 m."""

    def __init__(self, folder: Path) -> None:
        self.params = Parameters("guard", GuardConfig(), ROBOT)
        self.params.set("margin", 0.5)
        self.file = folder / "params" / "guard.json"
        self._server = ParameterServer(
            "guard", "guard-1", "host", self.params, Folder(folder), logging.getLogger("guard").info
        )
        self._saves: Inbox[Any] = Inbox(20)

    def ask(self, name: str = "margin") -> Asked:
        asked = Asked(ParamSave(names=(name,), by="carer"))
        self._saves.accept(asked)
        return asked

    def has_answered(self, asked: Asked) -> bool:
        """After another turn."""
        self.turn()
        return asked.said is not None

    def turn(self) -> None:
        self._server.turn(Inbox(1), Inbox(1), self._saves, None)


def test_who_asks_without_end_at_a_slow_disk_takes_no_other_thread(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ready = threading.Event()

    def written(path: Path, data: bytes) -> None:
        assert ready.wait(10.0)
        path.write_bytes(data)

    monkeypatch.setattr("giraff_node.process.state.write_file_durably", written)
    desk = Desk(tmp_path)
    before = threading.active_count()
    first = last = desk.ask()
    for _ in range(200):
        desk.turn()
        last = desk.ask()
    assert threading.active_count() == before
    ready.set()
    for asked in (first, last):
        wait(partial(desk.has_answered, asked), what="it is answered")
    assert last.said is not None
    assert last.said.done
    assert msgspec.json.decode(desk.file.read_bytes()) == {"margin": 0.5}


def test_each_of_those_who_wait_is_answered_by_itself(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    saved, unknown, saved_again = desk.ask(), desk.ask("marign"), desk.ask()
    wait(lambda: desk.has_answered(saved_again), what="the last is answered")
    assert [asked.said.done for asked in (saved, unknown, saved_again) if asked.said] == [True, False, True]
    assert unknown.said is not None
    assert "did you mean guard.margin" in str(unknown.said.reason)
