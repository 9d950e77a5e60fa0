"""What the tests of this folder share: one robot that none of them harms for good, and a desk beside it."""

from collections.abc import Iterator

import pytest

from tests.functional.desk.conftest import desk
from tests.support.process_robot import ProcessRobot, process_robot

__all__ = ["desk"]


@pytest.fixture(scope="package")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    """Start a whole simulated robot, sim-test, in the proving room."""
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as started:
        yield started


@pytest.fixture(scope="module")
def robot(standing: ProcessRobot) -> ProcessRobot:
    """That robot as each file finds it: armed in the middle of the room, by a level hand."""
    standing.simulator.place(0.0, 0.0)
    says = standing.simulator.state().base
    if says is None or says.latch != "none":
        standing.release()
    else:
        standing.arm()
    return standing
