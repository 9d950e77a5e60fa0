"""The wheels of a robot are waited for before anything is begun."""

import math
from typing import Any, cast

import pytest

from giraff_schemas.messages import Wheels
from giraff_schemas.topics import WHEELS, Topic
from giraff_setup.wheels.odometry.calibrate import NetworkWheels
from giraff_tools.network.connection import Listener
from tests.unit.setup.person import FiledRobot


class Connection:
    """To a robot that speaks at its `at`-th turn; never, where that is 0."""

    def __init__(self, sample: Wheels, at: int) -> None:
        self._sample, self._at, self._turn = sample, at, 0

    def subscribe(self, topic: Topic[Any]) -> None:
        assert topic is WHEELS

    def dispatch(self, listener: Listener) -> None:
        self._turn += 1
        if self._turn == self._at:
            listener.on_sample(WHEELS, "wheels", self._sample, 0)


@pytest.fixture
def sample() -> Wheels:
    return FiledRobot().waiting[0]


def test_the_first_wheels_are_waited_for_and_kept(sample: Wheels) -> None:
    wheels = NetworkWheels(cast(Any, Connection(sample, 3)))
    assert wheels.silence == math.inf
    assert wheels.wait(math.inf)
    assert wheels.silence < math.inf
    assert wheels.poll() == [sample]


def test_wheels_that_never_come_are_not_waited_for_any_longer(sample: Wheels) -> None:
    assert not NetworkWheels(cast(Any, Connection(sample, 0))).wait(0.0)
