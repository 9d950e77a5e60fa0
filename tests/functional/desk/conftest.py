"""What the tests of the operator's desk share: for each file a robot, which none may harm, and a desk beside it."""

from collections.abc import Iterator

import pytest

from tests.support.desk import Desk
from tests.support.process_robot import ProcessRobot, process_robot


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    """A whole simulated robot, sim-test, standing in the proving room."""
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as started:
        yield started


@pytest.fixture(scope="module")
def desk(robot: ProcessRobot, tmp_path_factory: pytest.TempPathFactory) -> Desk:
    """Where the commands for that robot are called."""
    return Desk(tmp_path_factory.mktemp("desk"), robot.environment["GIRAFF_NETWORK_RENDEZVOUS"], "sim-test")
