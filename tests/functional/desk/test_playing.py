"""A recording is said again, where nothing else is to do, faster than anybody listens."""

from __future__ import annotations

from pathlib import Path

from giraff_cli.watcher import free_port
from tests.support.desk import Desk
from tests.support.recorders import all_of, hearing, require_the_same
from tests.unit.replay.drive import begin_of_the_drive

SECONDS_NS = 10_000_000_000
"""Of the drive, from its begin."""
REPLAY = "replay-sim-test"


def test_however_fast_it_is_said_nothing_is_left_out(tmp_path: Path) -> None:
    alone, path = Desk(tmp_path, f"127.0.0.1:{free_port()}"), tmp_path / "begin.mcap"
    recorded = begin_of_the_drive(path, SECONDS_NS)
    with hearing(alone.rendezvous, REPLAY) as ear:
        done = alone.run("play", str(path), "--rate", "100")
        assert (done.returncode, done.stderr) == (0, "")
        assert f"as {REPLAY}: {len(recorded)} samples" in done.stdout
        heard = all_of(ear, len(recorded))
    require_the_same(heard, recorded, REPLAY)
