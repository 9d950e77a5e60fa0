"""The rhythm in which a recording is said again, where nothing else is to do."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from giraff_mcap.ear import Ear
from giraff_mcap.heard import Heard
from giraff_mcap.reading import Recorded, Recording
from giraff_mcap.writing import RecordingWriter
from tests.unit.replay.make_drive import DRIVE
from tests.support.desk import Desk
from tests.support.recorders import hearing, require_the_same
from tests.support.waiting import wait
from tests.timing.sleepers import stalls_seen

SECONDS_NS = 10_000_000_000
"""Of the drive, from its begin."""
WITHIN_NS = 2_000_000
"""What a sample that is said again may be beside its time."""
REPLAY = "replay-sim-test"


@pytest.fixture(scope="module")
def begin(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Recorded]]:
    """A file of the drive's first seconds, and what is in it."""
    path = tmp_path_factory.mktemp("begin") / "begin.mcap"
    samples = list(Recording(DRIVE).samples())
    recorded = [sample for sample in samples if sample.heard_ns < samples[0].heard_ns + SECONDS_NS]
    with RecordingWriter(path, {"robot": "sim-test"}) as writer:
        writer.add([Heard(sample.heard_ns, sample.topic, sample.payload(), sample.encoding) for sample in recorded])
        writer.close("test")
    return path, recorded


def all_of(ear: Ear, count: int) -> list[Heard]:
    """As many samples as were recorded, in the order in which they came."""
    heard: list[Heard] = []

    def all_came() -> bool:
        heard.extend(ear.take())
        return len(heard) >= count

    wait(all_came, 5.0, what="the last sample")
    return heard


def test_it_is_said_again_in_its_order_and_rhythm(desk: Desk, begin: tuple[Path, list[Recorded]]) -> None:
    alone = desk.alone()
    path, recorded = begin
    gc.disable()  # which holds up whoever listens here for longer than a sample may be late
    try:
        with hearing(alone.rendezvous, REPLAY) as ear, stalls_seen(alone.directory) as stalls:
            done = alone.run("play", str(path))
            heard = all_of(ear, len(recorded))
    finally:
        gc.enable()
    assert (done.returncode, done.stderr) == (0, "")
    assert f"as {REPLAY}: {len(recorded)} samples" in done.stdout
    require_the_same(heard, recorded, REPLAY)
    delays = [one.at_ns - sample.heard_ns for one, sample in zip(heard, recorded, strict=True)]
    usual = sorted(delays)[len(delays) // 2]
    late = [i for i, delay in enumerate(delays) if abs(delay - usual) > WITHIN_NS]
    unexplained = [i for i in late if not stalls.at(heard[i].at_ns - abs(delays[i] - usual), heard[i].at_ns)]
    print(f"{len(late)} of {len(delays)} not within 2 ms, {len(unexplained)} of them without a stall of the machine")
    print(done.stdout)
    assert len(unexplained) <= len(delays) // 100
    assert sorted(delays)[len(delays) * 3 // 4] - usual < WITHIN_NS


def test_however_fast_it_is_said_nothing_is_left_out(desk: Desk, begin: tuple[Path, list[Recorded]]) -> None:
    alone = desk.alone()
    path, recorded = begin
    with hearing(alone.rendezvous, REPLAY) as ear:
        done = alone.run("play", str(path), "--rate", "100")
        assert (done.returncode, done.stderr) == (0, "")
        heard = all_of(ear, len(recorded))
    require_the_same(heard, recorded, REPLAY)
