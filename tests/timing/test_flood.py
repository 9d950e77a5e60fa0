"""Two thousand commands a second of a stranger beside a driving robot: it stops in time, and says whose they are."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.lease import ASK
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.health import Health
from giraff_schemas.messages import DriveCommand, Tick
from giraff_schemas.topics import OPERATOR_CMD_VEL, TICK, health_key, key_of
from tests.support.process_robot import ARENA, PATIENCE, ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall

NAME: Final = "sim-test"
STRANGER: Final = OPERATOR_CMD_VEL.at("stranger")
RATE: Final = 2000
BURST: Final = 20
BOUND: Final = 0.45
"""s from the end of the joystick to the last PWM, as without a flood."""


@contextmanager
def flood(robot: ProcessRobot) -> Iterator[list[int]]:
    """Commands of somebody who does not drive, each with a fresh moment; how many so far."""
    sent, ends = [0], threading.Event()
    robot.observer.follow(TICK)
    publisher = robot.observer.session.declare_publisher(
        key_of(NAME, STRANGER), encoding=encoding_of(DriveCommand), express=True
    )

    def speak() -> None:
        due = time.monotonic()
        while not ends.is_set():
            tick: Tick | None = robot.observer.newest(TICK)
            for _ in range(BURST if tick is not None else 0):
                command = DriveCommand(
                    operator="stranger",
                    lease_counter=ASK,
                    linear_x=-0.6,
                    angular_z=0.0,
                    source="hand",
                    tick=tick.time if tick is not None else None,
                )
                publisher.put(encode(stamped(command, sent[0], time.time_ns(), "0123456789abcdef")))
                sent[0] += 1
            due += BURST / RATE
            ends.wait(max(0.0, due - time.monotonic()))

    thread = threading.Thread(target=speak)
    thread.start()
    try:
        yield sent
    finally:
        ends.set()
        thread.join()


def guards_notices(robot: ProcessRobot) -> tuple[str, ...]:
    for reply in robot.observer.session.get(health_key(NAME, "guard"), timeout=2.0):
        if reply.ok is not None:
            return tuple(map(str, msgspec.msgpack.decode(bytes(reply.ok.payload), type=Health).notices))
    return ()


def test_a_flood_of_a_stranger_changes_no_bound_and_is_told(tmp_path: Path) -> None:
    with process_robot(tmp_path, ARENA, truth="exact") as robot:
        robot.drive_forward()
        with flood(robot) as sent:
            began, before = time.monotonic(), sent[0]
            robot.wait("whose flood it is", lambda: any("stranger" in each for each in guards_notices(robot)), PATIENCE)
            rate = (sent[0] - before) / (time.monotonic() - began)
            robot.drive(-7.5, 0.0, 1.0)
            begin_ns = time.monotonic_ns()
            killed_us = robot.simulator.now()
            robot.kill("joystick")
            robot.run(BOUND + 1.0)
            last_us = robot.simulator.record(killed_us).last_driven_us
        robot.require_all()
        took = ((last_us or killed_us) - killed_us) / 1e6
        print(f"{rate:.0f} commands a second: PWM ends {took:.3f} s after the joystick")
        with by_the_wall(begin_ns):
            assert rate > 0.8 * RATE
            assert took <= BOUND
