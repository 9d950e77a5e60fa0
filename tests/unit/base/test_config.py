"""What a robot file that leaves it out says of [base]."""

import msgspec
import pytest

from tests.support import balancer_file
from tests.support.robot_files import ROBOTS
from tests.support.robots import BASE


def test_what_a_robot_file_leaves_out_is_what_safety_was_reckoned_with() -> None:
    """Each stands in the figures of docs/safety.md: to change one is to measure them again."""
    default = BASE
    assert (default.operator_budget, default.guard_budget, default.range_budget) == (0.4, 0.2, 0.4)
    assert (default.reset_budget, default.disarm_time, default.guard_silence) == (1.0, 1.0, 0.5)
    assert (default.arm_time, default.neutral_gap) == (0.2, 0.1)
    assert (default.linear_acceleration, default.angular_acceleration) == (0.6, 2.5)
    assert (default.battery_low, default.battery_cutoff) == (22.0, 20.0)


def test_a_cutoff_that_never_counts_is_refused() -> None:
    balancer = msgspec.structs.replace(BASE, drive=balancer_file.DRIVE, battery_low=11.8, battery_cutoff=10.5)
    with pytest.raises(ValueError, match=r"battery_cutoff is 10\.4 V: it must be above drive\.battery_minimum"):
        msgspec.structs.replace(balancer, battery_cutoff=10.4)
    msgspec.structs.replace(balancer, battery_cutoff=0.0)


def test_the_port_of_a_controller_is_its_process_alone() -> None:
    base = ROBOTS["roboclaw"].settings.base
    msgspec.structs.replace(base, port="/dev/pts/7")
    with pytest.raises(ValueError, match="port is /dev/ttyACM0: only the process giraff-board@roboclaw opens"):
        msgspec.structs.replace(base, port="/dev/ttyACM0")
