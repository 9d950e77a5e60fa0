"""Who speaks to the guard's authority, before and after somebody has asked for the lease."""

import pytest

from tests.unit.guard.lease import Room


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
