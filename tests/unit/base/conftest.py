"""A robot as many tests of base begin with it."""

import pytest

from tests.unit.base.rig import Rig


@pytest.fixture
def rig() -> Rig:
    return Rig()


@pytest.fixture
def armed() -> Rig:
    rig = Rig()
    rig.arm()
    return rig


@pytest.fixture
def driven() -> Rig:
    """It was armed, and drives at 0.6 m/s."""
    rig = Rig()
    rig.drive(0.6)
    return rig
