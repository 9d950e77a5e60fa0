"""The rhythm in which a recording is said again, where nothing else is to do, and its pace."""

import gc
import time
from pathlib import Path

import pytest

from giraff_mcap.reading import Recording
from giraff_tools.network.ports import free_port
from tests.support.desk import Desk
from tests.support.recorders import all_of, hearing, require_the_same
from tests.timing.sleepers import stalls_seen
from tests.timing.stalled import by_the_wall
from tests.unit.replay.drive import begin_of_the_drive

SECONDS_NS = 10_000_000_000
"""Of the drive, from its begin."""
WITHIN_NS = 2_000_000
"""What a sample that is said again may be beside its time."""
REPLAY = "replay-sim-test"


def test_it_is_said_again_in_its_order_and_rhythm(tmp_path: Path) -> None:
    alone, path = Desk(tmp_path, f"127.0.0.1:{free_port()}"), tmp_path / "begin.mcap"
    recorded = begin_of_the_drive(path, SECONDS_NS)
    gc.disable()  # which holds up whoever listens here for longer than a sample may be late
    try:
        with hearing(alone.rendezvous, REPLAY) as subscriber, stalls_seen(alone.directory) as stalls:
            done = alone.run("play", str(path))
            heard = all_of(subscriber, len(recorded))
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


@pytest.mark.parametrize("rate", [1.0, 10.0])
def test_it_keeps_its_pace(tmp_path: Path, rate: float) -> None:
    alone, path = Desk(tmp_path, f"127.0.0.1:{free_port()}"), tmp_path / "begin.mcap"
    begin_of_the_drive(path, SECONDS_NS)
    began_ns = time.monotonic_ns()
    played = alone.json("play", str(path), "--rate", f"{rate:g}")
    with by_the_wall(began_ns):
        assert played["seconds"] == pytest.approx(Recording(path).seconds / rate, abs=0.3)
