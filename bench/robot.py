"""The whole simulated robot: what each service uses while it drives, beside bare Zenoh with the same traffic."""

import json
import random
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from bench.figures import BARE, MEASURED, ROBOT_SIDE, SUM, Figures
from bench.meter import usage
from bench.pairs import session_environment
from giraff_schemas.codec import encode
from giraff_schemas.services import SERVICES, Service
from giraff_schemas.topics import ATTITUDE, BUMPER, SCAN, Topic
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.support.process_robot import ARENA, FULL_TILT, process_robot
from tests.timing.hand_to_wheel import figures as stage_figures
from tests.timing.hand_to_wheel import measured
from tests.timing.sleepers import stalls_seen
from tests.unit.schemas.samples import an_example

_SENSORS: Final = ("front_left", "front_right", "rear")
_UNUSED: Final = (ATTITUDE, BUMPER, SCAN)
"""Topics that a robot on two wheels without bumpers and scanner never has."""
_SECONDS: Final = 8.0
_PAIRS: Final = 4
"""Of a start and a stop of the hand in a round."""


def measure(figures: Figures) -> None:
    """One round: the robot drives in circles; its hand starts and stops; then bare Zenoh has the same traffic."""
    with (
        TemporaryDirectory(prefix="bench") as folder,
        stalls_seen(Path(folder)) as stalls,
        process_robot(Path(folder), ARENA, truth="exact") as robot,
    ):
        for more in ("motion", "door"):
            robot.start(more)
        robot.drive(FULL_TILT / 3.0, FULL_TILT, 2.0)
        _use(figures, "", {name: robot.pid(name) for name in MEASURED}, robot.run)
        trials = measured(robot, _PAIRS, random.Random(len(figures.values)), stalls)
    stops = stage_figures([trial for trial in trials if trial.does == "stop"])
    starts = stage_figures([trial for trial in trials if trial.does == "start"])
    for name, stages in (("stop", stops), ("start", starts)):
        figures.add("hand to wheel p50", name, stages["whole"]["p50"])
    with _bare_traffic() as pids:
        time.sleep(1.0)
        _use(figures, BARE, pids, time.sleep)


def plan(service: Service) -> dict[str, Any]:
    """Return the traffic of a service at its nominal rates; see traffic.py."""
    return {
        "publish": [
            (topic.key, topic.rate_hz, len(encode(topic.schema(**an_example(topic.schema)))), topic.qos == "control")
            for row in service.publishes
            for topic in _keys(row, service.name)
            if topic.rate_hz
        ],
        "subscribe": [row.key for row in service.subscribes if row not in _UNUSED],
    }


def _keys(row: Topic[Any], service: str) -> list[Topic[Any]]:
    if row in _UNUSED:
        return []
    names = {"sensor": _SENSORS, "operator": (service,)}.get(row.names, ())
    return [row.at(name) for name in names] or [row]


def _use(figures: Figures, kind: str, pids: Mapping[str, int], wait: Callable[[float], object]) -> None:
    before, began = {name: usage(pid) for name, pid in pids.items()}, time.monotonic()
    wait(_SECONDS)
    after, took = {name: usage(pid) for name, pid in pids.items()}, time.monotonic() - began
    for name, now in after.items():
        figures.add("processor", kind + name, (now.worked - before[name].worked) / took * 100.0)
        figures.add("wake-ups", kind + name, (now.wakes - before[name].wakes) / took)
        figures.add("threads", kind + name, now.threads)
        figures.add("RSS", kind + name, now.rss)
        figures.add("PSS", kind + name, now.pss)
    share = sum(figures.values["processor"][kind + name][-1] for name in ROBOT_SIDE)
    figures.add("processor", kind + SUM, share)


@contextmanager
def _bare_traffic() -> Iterator[dict[str, int]]:
    """A process of bare Zenoh for each service; their pids."""
    rows = [service for service in SERVICES if service.name in MEASURED]
    with ExitStack() as end:
        folder, port, pids = Path(end.enter_context(TemporaryDirectory(prefix="bench"))), free_port(), {}
        for row in rows:
            words = [sys.executable, "-P", "-m", "bench.traffic", json.dumps(plan(row))]
            process = subprocess.Popen(words, env=session_environment(folder, row.name, port), cwd=ROOT)
            end.callback(process.wait)
            end.callback(process.kill)
            pids[row.name] = process.pid
        yield pids
