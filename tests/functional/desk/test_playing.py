"""A recording is said again, where nothing else is to do, faster than anybody listens."""

from pathlib import Path

from giraff_mcap.raw_sample import RawSample
from giraff_tools.network.ports import free_port
from tests.support.desk import Desk
from tests.support.recorders import hearing, require_the_same
from tests.support.waiting import wait
from tests.unit.replay.drive import begin_of_the_drive

SECONDS_NS = 10_000_000_000
"""Of the drive, from its begin."""
REPLAY = "replay-sim-test"


def test_however_fast_it_is_said_nothing_is_left_out(tmp_path: Path) -> None:
    """Again until somebody hears all of it: on a busy machine who listens may be met late, and misses the begin."""
    alone, path = Desk(tmp_path, f"127.0.0.1:{free_port()}"), tmp_path / "begin.mcap"
    recorded = begin_of_the_drive(path, SECONDS_NS)
    count = len(recorded)
    heard: list[RawSample] = []
    with hearing(alone.rendezvous, REPLAY) as subscriber:

        def is_said_to_all() -> bool:
            done = alone.run("play", str(path), "--rate", "100")
            assert (done.returncode, done.stderr) == (0, "")
            assert f"as {REPLAY}: {count} samples" in done.stdout
            heard.extend(subscriber.pop_all())
            return len(heard) >= count

        def last_has_come() -> bool:
            heard.extend(subscriber.pop_all())
            return heard[-1].payload == recorded[-1].payload

        wait(is_said_to_all, 60.0, what="somebody who hears all of it")
        wait(last_has_come, 60.0, what="the last sample")
    require_the_same(heard[-count:], recorded, REPLAY)
