"""Ten minutes of a drive, recorded: every sample, at what cost, and what the drive feels of it."""

from __future__ import annotations

import time
from collections import defaultdict
from pathlib import Path
from statistics import median, quantiles

import msgspec
import psutil
from mcap.reader import make_reader

from giraff_schemas.messages import BaseState
from giraff_schemas.topics import BASE
from tests.campaign.records import write_record
from tests.desk.recorders import giraff_process, records
from tests.system.robot import FULL_TILT, ProcessRobot, process_robot

SECONDS = 600.0
ALONE = 60.0
"""s before and after, without a recorder: what a drive is like on this machine."""
MOST_OF_A_CORE = 0.05
MOST_OLDER = 1.1
"""Times the age of a command without a recorder."""


def threads_of(process: psutil.Process) -> dict[str, float]:
    """CPU seconds by the name of a thread, those of one kind together."""
    spent: dict[str, float] = defaultdict(float)
    for thread in process.threads():
        try:
            name = Path(f"/proc/{process.pid}/task/{thread.id}/comm").read_text().strip()
        except OSError:  # it has just ended
            continue
        spent[name.partition("-")[0]] += thread.user_time + thread.system_time
    return spent


class Ages:
    """s from the operator's measurement to the drive frame, as base says it: while recorded, and while not."""

    def __init__(self, robot: ProcessRobot) -> None:
        self.alone: list[float] = []
        self.recorded: list[float] = []
        self.now = self.alone
        robot.observer.listen(BASE, self._hear)

    def _hear(self, base: BaseState) -> None:
        if base.driving and base.round_trip is not None:
            self.now.append(base.round_trip)


def test_ten_minutes_are_recorded_and_cost_little(tmp_path: Path) -> None:
    path = tmp_path / "ten-minutes.mcap"
    with process_robot(tmp_path, boards="host") as robot:
        robot.drive(FULL_TILT / 3.0, FULL_TILT, 2.0)
        ages = Ages(robot)
        time.sleep(ALONE)
        with giraff_process(robot, "record", "-o", path.name, "--for", f"{SECONDS:g}", "--json") as recorder:
            records(recorder, path)
            ages.now = ages.recorded
            process = psutil.Process(recorder.pid)
            before, began = threads_of(process), time.monotonic()
            time.sleep(SECONDS - 10.0)
            after, took = threads_of(process), time.monotonic() - began
            resident = process.memory_info().rss
            output, _ = recorder.communicate(timeout=60.0)
        ages.now = ages.alone
        time.sleep(ALONE)
    report = msgspec.json.decode(output)
    shares = {name: (after[name] - before.get(name, 0.0)) / took for name in after}
    sequences: dict[str, list[int]] = defaultdict(list)
    with path.open("rb") as file:
        for _, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            sequences[channel.topic].append(message.sequence)
    share, older = sum(shares.values()), median(ages.recorded) / median(ages.alone)
    written = write_record(
        "recording",
        {
            "seconds": report["seconds"],
            "samples": report["samples"],
            "bytes": report["bytes"],
            "lost": report["lost"],
            "share_of_a_core": round(share, 4),
            "share_by_threads": {name: round(of, 4) for name, of in shares.items() if of >= 0.0001},
            "resident_bytes": resident,
            "command_age_s": {
                name: {"median": round(median(of), 4), "p99": round(quantiles(of, n=100)[98], 4)}
                for name, of in (("alone", ages.alone), ("recorded", ages.recorded))
            },
            "command_age_ratio": round(older, 3),
        },
    )
    print(written.read_text())
    for key, numbers in sequences.items():
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers))), key
    assert sum(map(len, sequences.values())) == report["samples"]
    assert report["lost"] == 0
    assert share <= MOST_OF_A_CORE
    assert older <= MOST_OLDER
