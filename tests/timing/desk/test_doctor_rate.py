"""`giraff doctor` beside a service that is too slow."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.functional.desk.sick import Told, doctor, faults, until
from tests.support.process_robot import process_robot


@contextmanager
def half_asleep(pid: int) -> Iterator[None]:
    """A process that gets half of the processor's time, as on a machine with too much to do."""
    ended = threading.Event()

    def nag() -> None:
        while not ended.is_set():
            os.kill(pid, signal.SIGSTOP)
            time.sleep(0.12)
            os.kill(pid, signal.SIGCONT)
            time.sleep(0.02)

    thread = threading.Thread(target=nag)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
        os.kill(pid, signal.SIGCONT)


def test_a_rate_that_is_too_low_is_a_fault(tmp_path: Path) -> None:
    def is_named(told: Told) -> bool:
        words = ("guard: cmd_vel comes at ", "instead of 50", "overloaded")
        return any(all(word in fault for word in words) for fault in faults(told))

    with process_robot(tmp_path, boards="host") as robot, half_asleep(robot.pid("guard")):
        told = until(robot, lambda: doctor(robot.environment, cwd=robot.directory), is_named)
    assert told[0] == 1
