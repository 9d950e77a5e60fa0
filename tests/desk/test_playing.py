"""The rhythm in which a recording is said again, where nothing else is to do."""

from __future__ import annotations

import gc
import json
import time
from pathlib import Path

import zenoh

from giraff_mcap.heard import Heard
from giraff_mcap.reading import Recorded, Recording
from giraff_mcap.writing import RecordingWriter
from giraff_node.session import NetworkConfig, close_session, session_config
from giraff_schemas.topics import key_below
from tests.desk.desk import Desk
from tests.desk.make_drive import DRIVE
from tests.sleepers import stalls_seen
from tests.waiting import wait

SECONDS_NS = 10_000_000_000
"""Of the drive, from its begin."""
WITHIN_NS = 2_000_000
"""What a sample that is said again may be beside its time."""
REPLAY = "replay-sim-test"


def begin_of_drive(path: Path) -> list[Recorded]:
    """Write the drive's first seconds to another file, and what is in it."""
    samples = list(Recording(DRIVE).samples())
    begin = [sample for sample in samples if sample.heard_ns < samples[0].heard_ns + SECONDS_NS]
    with RecordingWriter(path, {"robot": "sim-test"}) as writer:
        writer.add([Heard(sample.heard_ns, sample.topic, sample.payload(), sample.encoding) for sample in begin])
        writer.close("test")
    return begin


def test_it_is_said_again_in_its_order_and_rhythm(desk: Desk) -> None:
    alone = desk.alone()
    path = alone.directory / "begin.mcap"
    recorded = begin_of_drive(path)
    network = NetworkConfig(local=True, rendezvous=alone.rendezvous)
    session = zenoh.open(zenoh.Config.from_json5(json.dumps(session_config(network, REPLAY))))
    heard: list[tuple[int, str, bytes, str]] = []

    def hear(sample: zenoh.Sample) -> None:
        heard.append((time.monotonic_ns(), str(sample.key_expr), bytes(sample.payload), str(sample.encoding)))

    subscriber = session.declare_subscriber(key_below(REPLAY, "**"), hear)
    gc.disable()  # which holds up whoever listens here for longer than a sample may be late
    try:
        with stalls_seen(alone.directory) as stalls:
            done = alone.run("play", path.name)
            wait(lambda: len(heard) == len(recorded), 5.0, what="the last sample")
    finally:
        gc.enable()
        del subscriber
        close_session(session)
    assert (done.returncode, done.stderr) == (0, "")
    assert f"as {REPLAY}: {len(recorded)} samples" in done.stdout
    assert [(key, payload, encoding) for _, key, payload, encoding in heard] == [
        (sample.topic.replace("sim-test", REPLAY), sample.payload(), sample.encoding) for sample in recorded
    ]
    delays = [at - sample.heard_ns for (at, *_), sample in zip(heard, recorded, strict=True)]
    usual = sorted(delays)[len(delays) // 2]
    late = [i for i, delay in enumerate(delays) if abs(delay - usual) > WITHIN_NS]
    unexplained = [i for i in late if not stalls.at(heard[i][0] - abs(delays[i] - usual), heard[i][0])]
    print(f"{len(late)} of {len(delays)} not within 2 ms, {len(unexplained)} of them without a stall of the machine")
    print(done.stdout)
    assert len(unexplained) <= len(delays) // 100
    assert sorted(delays)[len(delays) * 3 // 4] - usual < WITHIN_NS
