"""A machine that was suspended, as its kernel shows it to a process."""

import subprocess
import sys

import pytest

from giraff_node import robot_now_ns

SUSPENDED = 1000  # s


def test_the_robots_clock_has_gone_on_while_the_machine_was_suspended() -> None:
    """What was queued before is old after it."""
    asks = "from giraff_node import robot_now_ns; print(robot_now_ns())"
    done = subprocess.run(
        ["unshare", "--time", "--boottime", str(SUSPENDED), sys.executable, "-c", asks],
        check=True,
        capture_output=True,
        text=True,
    )
    assert int(done.stdout) * 1e-9 == pytest.approx(robot_now_ns() * 1e-9 + SUSPENDED, abs=60.0)
