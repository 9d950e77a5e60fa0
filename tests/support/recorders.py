"""`giraff record` and `giraff play` beside a running robot, and who hears what is played."""

import json
import random
import subprocess
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil
import zenoh

from giraff_core.network import NetworkConfig
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.raw_subscriber import RawSubscriber
from giraff_mcap.reading import Recorded
from giraff_node.network.session import close_session, session_config
from giraff_schemas.topics import key_below
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import ProcessRobot
from tests.support.waiting import wait


@contextmanager
def giraff_process(robot: ProcessRobot, *words: str, **popen: Any) -> Iterator[subprocess.Popen[str]]:
    """A command on the robot's host, which ends with the block."""
    command = [str(GIRAFF), *words]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, env=robot.environment, cwd=robot.directory, **streams | popen) as process:
        try:
            yield process
        finally:
            process.kill()


def records(process: subprocess.Popen[str], path: Path) -> None:
    """Wait until the first samples are on disk."""

    def has_begun() -> bool:
        assert process.poll() is None
        return path.exists() and path.stat().st_size >= 20_000

    wait(has_begun, 60.0, what="a recording", every=0.05)


def share_of_a_core(process: psutil.Process, seconds: float) -> float:
    """That a process takes from now on."""
    before, began = sum(process.cpu_times()[:2]), time.monotonic()
    time.sleep(seconds)
    return float(sum(process.cpu_times()[:2]) - before) / (time.monotonic() - began)


def killed_recording(robot: ProcessRobot, name: str) -> tuple[Path, int]:
    """A recording whose process was killed at any moment, and when, ns since 1970."""
    path = robot.directory / name
    with giraff_process(robot, "record", "-o", name) as process:
        records(process, path)
        time.sleep(random.uniform(1.0, 3.0))
        process.kill()
        return path, time.time_ns()


@contextmanager
def hearing(rendezvous: str, robot: str) -> Iterator[RawSubscriber]:
    """To all that comes of a robot, as long as the block lasts, on a loopback whose rendezvous nobody else owns."""
    network = NetworkConfig(local=True, rendezvous=rendezvous)
    session = zenoh.open(zenoh.Config.from_json5(json.dumps(session_config(network, robot, "apart"))))
    subscriber = RawSubscriber(session, [key_below(robot, "**")])
    try:
        yield subscriber
    finally:
        subscriber.close()
        close_session(session)


def all_of(subscriber: RawSubscriber, count: int) -> list[RawSample]:
    """As many samples as were recorded, in the order in which they came."""
    heard: list[RawSample] = []

    def all_came() -> bool:
        heard.extend(subscriber.pop_all())
        return len(heard) >= count

    wait(all_came, 60.0, what="the last sample")
    return heard


def require_the_same(heard: Iterable[RawSample], recorded: Iterable[Recorded], robot: str) -> None:
    """What `robot` said again is what sim-test had said, byte for byte and in its order."""
    for again, sample in zip(heard, recorded, strict=True):
        said = (sample.topic.replace("sim-test", robot), sample.payload, sample.encoding)
        assert (again.key, again.payload, again.encoding) == said
