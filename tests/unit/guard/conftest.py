"""Guards, their obstacles and their authority as many tests begin with them."""

import pytest

from tests.unit.guard.lease import Room
from tests.unit.guard.rig import Rig
from tests.unit.guard.senses import Senses, opened


@pytest.fixture
def room() -> Room:
    return Room()


@pytest.fixture
def held() -> Room:
    """A room in which A holds the lease."""
    room = Room()
    room.say("A", 0)
    assert room.holder == "A"
    return room


@pytest.fixture
def rig() -> Rig:
    return Rig()


@pytest.fixture
def senses() -> Senses:
    """All ways have been heard to be free."""
    return opened()
