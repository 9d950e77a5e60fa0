"""What the tests of the simulator share."""

import pytest

from giraff_sim.board import Implementation


@pytest.fixture(params=[*Implementation], ids=str)
def implementation(request: pytest.FixtureRequest) -> Implementation:
    """Each of the two ways a board's firmware runs."""
    return Implementation(request.param)
