"""A robot on an open floor that is asked for motions."""

from __future__ import annotations

import pytest

from tests.unit.motion.bench import Bench


@pytest.fixture
def bench() -> Bench:
    return Bench()
