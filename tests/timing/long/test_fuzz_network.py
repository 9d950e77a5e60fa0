"""Payloads over the network at a robot of real processes, half an hour long: no crash, no motion, memory flat."""

from pathlib import Path

import msgspec
import pytest

from tests.fuzz.growth import LIMIT
from tests.support.network_fuzz import fuzz_network
from tests.support.process_robot import ARENA, process_robot
from tests.support.report import report

PAYLOADS = 60_000  # at each key
SEED = 2


@pytest.mark.timeout(0)
def test_payloads_over_the_network_at_real_processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # What is counted is what a service holds, not what allocators keep for later: Python's takes 1 MiB at a time, as
    # much as a service may grow by, and each of thirty threads keeps seven freed pieces of every size, after hours.
    monkeypatch.setenv("PYTHONMALLOC", "malloc")
    monkeypatch.setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0")
    with process_robot(tmp_path, ARENA) as robot:
        counted = fuzz_network(robot, PAYLOADS, SEED)
    report("timing/fuzz-network", msgspec.to_builtins(counted))
    assert max(counted.growth_bytes.values()) < LIMIT, counted
