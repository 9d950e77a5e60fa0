"""Payloads of any kind over the network, at each key of a robot of real processes: no crash, no motion."""

from pathlib import Path

from tests.support.network_fuzz import fuzz_network
from tests.support.process_robot import ARENA, process_robot

PAYLOADS = 40
"""At each key."""


def test_rubbish_over_the_network_moves_no_real_robot(tmp_path: Path) -> None:
    with process_robot(tmp_path, ARENA, boards="host") as robot:
        fuzz_network(robot, PAYLOADS, seed=1)
