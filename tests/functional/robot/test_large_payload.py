"""One payload as large as somebody likes, on all keys of a robot: nobody keeps it, and the robot drives on."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import load
from giraff_node.network.session import close_session, session_config
from giraff_schemas.health import Health
from giraff_schemas.topics import GUARD, TICK, health_key, key_below, key_of
from tests.support.process_robot import ARENA, BRIEF, PATIENCE, ProcessRobot, process_robot

NAME = "sim-test"
PAYLOAD = 60_000_000  # bytes
MOST_GROWTH = 20_000_000  # bytes
JUDGED = ("base", "guard")


@contextmanager
def stranger(robot: ProcessRobot) -> Iterator[zenoh.Session]:
    """A session on the robot's network that takes messages of any size, as any program with Zenoh does."""
    settings = session_config(load("network", NetworkConfig, robot.environment), NAME, "outside")
    del settings["transport"]["link"]["rx"]
    session = zenoh.open(zenoh.Config.from_json5(json.dumps(settings)))
    try:
        yield session
    finally:
        close_session(session)


def wait_for_links_to_base_and_guard(robot: ProcessRobot, session: zenoh.Session) -> None:
    """What base and guard say comes by no other way."""
    came: set[str] = set()
    declared: list[Any] = [
        session.declare_subscriber(key_of(NAME, topic), lambda sample: came.add(str(sample.key_expr)))
        for topic in (TICK, GUARD)
    ]
    robot.wait("base and guard at the stranger's", lambda: len(came) == len(declared), PATIENCE)
    for one in declared:
        one.undeclare()


def healths(robot: ProcessRobot, session: zenoh.Session) -> dict[str, Health]:
    """Of base and guard. They answer once they have taken from their links what was put before."""
    told: dict[str, Health] = {}

    def have_answered() -> bool:
        for service in JUDGED:
            for reply in session.get(health_key(NAME, service), timeout=2.0):
                if reply.ok is not None:
                    told[service] = msgspec.msgpack.decode(bytes(reply.ok.payload), type=Health)
        return len(told) == len(JUDGED)

    robot.wait("the health of base and guard", have_answered, PATIENCE)
    return told


def peak_of(pid: int) -> int:
    """bytes that a process has had in memory at most."""
    [line] = [
        line
        for line in Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
        if line.startswith("VmHWM:")
    ]
    return int(line.split()[1]) * 1024


def test_a_payload_as_large_as_somebody_likes_costs_base_and_guard_nothing(tmp_path: Path) -> None:
    with (
        process_robot(tmp_path, ARENA, boards="host") as robot,
        stranger(robot) as sender,
        stranger(robot) as receiver,
    ):
        lengths: list[int] = []
        key = key_below(NAME, "**")
        with receiver.declare_subscriber(key, lambda sample: lengths.append(len(sample.payload))):
            wait_for_links_to_base_and_guard(robot, sender)
            robot.drive_forward(BRIEF)
            before = healths(robot, sender)
            peaks = {service: peak_of(health.pid) for service, health in before.items()}
            sender.put(key, bytes(PAYLOAD), congestion_control=zenoh.CongestionControl.BLOCK)
            robot.wait("the payload at who takes it", lambda: PAYLOAD in lengths, PATIENCE)
            after = healths(robot, sender)
        robot.drive_forward(BRIEF)
        robot.require_all()
        assert {name: (one.pid, one.instance) for name, one in after.items()} == {
            name: (one.pid, one.instance) for name, one in before.items()
        }
        grown = {service: peak_of(health.pid) - peaks[service] for service, health in after.items()}
        assert all(more < MOST_GROWTH for more in grown.values()), grown
