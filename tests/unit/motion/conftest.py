"""A robot on an open floor that is asked for motions."""

import pytest

from tests.unit.motion.bench import Bench


@pytest.fixture
def bench() -> Bench:
    return Bench()
