"""The thread that writes what is kept: it tells how that went, and nobody waits for the disk."""

import threading
from pathlib import Path

import pytest

from giraff_core.estop.latch import LATCH_FILE, RELEASED, EStopLatch, LatchSaver, load_latch
from giraff_node.process.state import Folder, write_file_durably
from giraff_schemas.trouble import Trouble
from tests.support.waiting import wait

ENGAGED = EStopLatch(engaged=True, id=7, by="keyboard", reason=Trouble("space bar"))


def saver_in(directory: Path) -> LatchSaver:
    return LatchSaver(Folder(directory).writer(LATCH_FILE))


def outcome_of(saver: LatchSaver) -> tuple[EStopLatch, str]:
    outcomes: list[tuple[EStopLatch, str]] = []

    def is_told() -> bool:
        outcome = saver.outcome()
        outcomes.extend([outcome] if outcome else [])
        return bool(outcomes)

    wait(is_told, 60.0, every=0.001)
    return outcomes[0]


def test_the_saver_writes_and_tells(tmp_path: Path) -> None:
    saver = saver_in(tmp_path)
    assert saver.outcome() is None
    saver.save(ENGAGED)
    assert outcome_of(saver) == (ENGAGED, "")
    assert load_latch(Folder(tmp_path), 41) == ENGAGED


def test_the_saver_says_why_and_where_and_works_again(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("no directory")
    saver = saver_in(blocked)
    saver.save(ENGAGED)
    latch, why = outcome_of(saver)
    assert latch == ENGAGED
    assert str(blocked) in why
    blocked.unlink()
    saver.save(RELEASED)
    assert outcome_of(saver) == (RELEASED, "")


def test_the_saver_does_not_wait_for_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    released, write = threading.Event(), write_file_durably

    def hang(path: Path, data: bytes) -> None:
        assert released.wait(60.0)
        write(path, data)

    monkeypatch.setattr("giraff_node.process.state.write_file_durably", hang)
    saver = saver_in(tmp_path)
    saver.save(ENGAGED)
    assert saver.outcome() is None
    released.set()
    assert outcome_of(saver) == (ENGAGED, "")


def test_a_writer_wakes_whoever_waits_for_its_outcome(tmp_path: Path) -> None:
    woken = threading.Event()
    writer = Folder(tmp_path, woken.set).writer("params/guard.json")
    writer.save(b"{}")
    assert woken.wait(60.0)
    assert writer.outcome() == ""
    assert (tmp_path / "params" / "guard.json").read_bytes() == b"{}"
