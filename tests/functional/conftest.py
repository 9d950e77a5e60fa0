"""Which functional tests come to one worker, after each other (`--dist=loadfile`)."""

import importlib
from typing import Any

import pytest

_SHARED = "tests/functional/one_robot"
"""Its files share a robot, which is dear to start and dearer to keep."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Give a worker a whole file, and one worker all files that share a robot."""
    if config.getoption("dist") != "loadfile":
        return None
    scheduler = importlib.import_module("xdist.scheduler").LoadFileScheduling(config, log)
    file_of = scheduler._split_scope
    scheduler._split_scope = lambda nodeid: _SHARED if nodeid.startswith(f"{_SHARED}/") else file_of(nodeid)
    return scheduler
