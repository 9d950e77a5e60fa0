"""Ten minutes of a drive, recorded: every sample, at what cost, what the drive feels of it, and said again."""

import gc
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import msgspec
import psutil
import pytest
from mcap.reader import make_reader

from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording
from giraff_schemas.messages import BaseState
from giraff_schemas.topics import BASE
from tests.support.process_robot import FULL_TILT, ProcessRobot, process_robot
from tests.support.recorders import giraff_process, hearing, killed_recording, records, require_the_same
from tests.support.waiting import wait

SECONDS = 600.0
IN_TURN = 30.0
"""s with a recorder and as long without one: the machine itself is faster at one time than at another."""
TURNS = 6
MOST_OF_A_CORE = 0.05
MOST_OLDER = 1.1
"""Times the age of a command without a recorder, in the median of the turns."""
MOST_MISSING = 1.0  # s, after a kill
FASTER = 4
"""Times, that it is said again."""
REPLAY = "replay-sim-test"
LISTENER = """
import sys, threading, zenoh
from giraff_mcap.raw_subscriber import lower_priority
from giraff_node.config.robot_file import load
from giraff_node.network.session import NetworkConfig, open_session
from giraff_schemas.topics import key_below
lower_priority()
session = open_session(load("network", NetworkConfig), "sim-test", "client")
listens = session.declare_subscriber(key_below("sim-test", "**"), zenoh.handlers.RingChannel(1))
threading.Event().wait()
"""
"""Hears all that a recorder hears, and does nothing with it: what Zenoh alone costs on this machine."""


class Cost:
    """Shares of a core that a process takes from now on, by its threads."""

    def __init__(self, pid: int) -> None:
        self._process = psutil.Process(pid)
        self._before, self._began = self._spent(), time.monotonic()

    def shares(self) -> dict[str, float]:
        """By the name of a thread, those of one kind together."""
        took = time.monotonic() - self._began
        return {name: (spent - self._before.get(name, 0.0)) / took for name, spent in self._spent().items()}

    @property
    def resident(self) -> int:
        """Bytes."""
        return int(self._process.memory_info().rss)

    def _spent(self) -> dict[str, float]:
        spent: dict[str, float] = defaultdict(float)
        for thread in self._process.threads():
            try:
                name = Path(f"/proc/{self._process.pid}/task/{thread.id}/comm").read_text(encoding="utf-8").strip()
            except OSError:  # it has just ended
                continue
            spent[name.partition("-")[0]] += thread.user_time + thread.system_time
        return spent


def command_ages(robot: ProcessRobot) -> tuple[list[list[float]], list[list[float]]]:
    """s from the operator's measurement to the drive frame, as base says it: while recorded, and while not, in turn."""
    now: list[float] = []

    def hear(base: BaseState) -> None:
        if base.driving and base.round_trip is not None:
            now.append(base.round_trip)

    def of_a_turn() -> list[float]:
        now.clear()
        time.sleep(IN_TURN)
        return list(now)

    robot.observer.listen(BASE, hear)
    recorded, alone = [], []
    for turn in range(TURNS):
        path = robot.directory / f"turn-{turn}.mcap"
        with giraff_process(robot, "record", "-o", path.name) as recorder:
            records(recorder, path)
            recorded.append(of_a_turn())
        alone.append(of_a_turn())
    return recorded, alone


def told(ages: list[list[float]]) -> dict[str, Any]:
    """Of all turns of a kind, s."""
    together = [age for turn in ages for age in turn]
    return {
        "median": round(median(together), 4),
        "p99": round(quantiles(together, n=100)[98], 4),
        "medians": [round(median(turn), 4) for turn in ages],
    }


def share_of_a_listener(robot: ProcessRobot) -> float:
    """Of a core."""
    with subprocess.Popen([sys.executable, "-c", LISTENER], env=robot.environment) as process:
        try:
            time.sleep(5.0)
            cost = Cost(process.pid)
            time.sleep(IN_TURN)
            return sum(cost.shares().values())
        finally:
            process.kill()


def as_played(robot: ProcessRobot, path: Path) -> dict[str, Any]:
    """Say a recording again, where nobody else speaks, and compare: what came of it, once all is alike."""
    recorded = list(Recording(path).samples())
    gc.freeze()  # half a million objects, which would be looked through while samples come
    words = ("play", path.name, "--rate", f"{FASTER}", "--json")
    heard: list[RawSample] = []
    with hearing(robot.environment["GIRAFF_NETWORK_RENDEZVOUS"], REPLAY) as subscriber:
        with giraff_process(robot, *words) as player:

            def has_ended() -> bool:
                heard.extend(subscriber.pop_all())
                return player.poll() is not None

            wait(has_ended, SECONDS, what="the end of giraff play", every=0.2)
            output, _ = player.communicate()
        time.sleep(1.0)  # the last may be on their way
        heard += subscriber.pop_all()
    require_the_same(heard, recorded, REPLAY)
    played: dict[str, Any] = msgspec.json.decode(output)
    return {"times_as_fast": FASTER, "samples": played["samples"], "seconds": played["seconds"]}


@pytest.mark.timeout(0)
def test_ten_minutes_are_recorded_and_cost_little(tmp_path: Path) -> None:
    path = tmp_path / "ten-minutes.mcap"
    with process_robot(tmp_path, boards="host") as robot:
        robot.drive(FULL_TILT / 3.0, FULL_TILT, 2.0)
        with giraff_process(robot, "record", "-o", path.name, "--for", f"{SECONDS:g}", "--json") as recorder:
            records(recorder, path)
            cost = Cost(recorder.pid)
            time.sleep(SECONDS - 10.0)
            shares, resident = cost.shares(), cost.resident
            output, _ = recorder.communicate(timeout=60.0)
        listener = share_of_a_listener(robot)
        recorded, alone = command_ages(robot)
        killed, killed_ns = killed_recording(robot, "killed.mcap")
    again = as_played(robot, path)
    report = msgspec.json.decode(output)
    sequences: dict[str, list[int]] = defaultdict(list)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        for _, channel, message in reader.iter_messages():
            sequences[channel.topic].append(message.sequence)
    share = sum(shares.values())
    older = median(median(one) / median(other) for one, other in zip(recorded, alone, strict=True))
    missing = (killed_ns - max(sample.heard_ns for sample in Recording(killed).samples())) * 1e-9
    report(
        "timing/recording",
        {
            "seconds": report["seconds"],
            "samples": report["samples"],
            "bytes": report["bytes"],
            "lost": report["lost"],
            "share_of_a_core": round(share, 4),
            "share_by_threads": {name: round(of, 4) for name, of in shares.items() if of >= 0.0001},
            "share_of_a_listener_that_records_nothing": round(listener, 4),
            "resident_bytes": resident,
            "command_age_s": {"recorded": told(recorded), "alone": told(alone)},
            "command_age_ratio": round(older, 3),
            "missing_after_a_kill_s": round(missing, 3),
            "said_again": again,
        },
    )
    for key, numbers in sequences.items():
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers))), key
    assert sum(map(len, sequences.values())) == report["samples"] == again["samples"]
    assert summary is not None
    assert len(summary.chunk_indexes) > SECONDS
    assert report["lost"] == 0
    assert share <= MOST_OF_A_CORE
    assert older <= MOST_OLDER
    assert missing <= MOST_MISSING
