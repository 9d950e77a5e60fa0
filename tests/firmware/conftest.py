"""The boards on the bench."""

from collections.abc import Iterator

import pytest

from giraff_schemas.boards import BASE_BOARD, JOYSTICK_BOARD, RANGER_BOARD
from giraff_sim.board import Implementation
from tests.firmware.bench import BaseBench, Bench, SpeedBench
from tests.firmware.builds import compiled, open_board


@pytest.fixture
def base() -> Iterator[BaseBench]:
    """A base board that was powered on 15 ms ago."""
    board = open_board(BASE_BOARD, compiled())
    yield BaseBench(board)
    board.close()


@pytest.fixture
def robot() -> Iterator[SpeedBench]:
    """A base board that was powered on 15 ms ago, with wheels that turn by what their motors get."""
    board = open_board(BASE_BOARD, compiled())
    yield SpeedBench(board)
    board.close()


@pytest.fixture
def joystick() -> Iterator[Bench]:
    board = open_board(JOYSTICK_BOARD, compiled())
    yield Bench(board)
    board.close()


@pytest.fixture
def ranger() -> Iterator[Bench]:
    board = open_board(RANGER_BOARD, compiled())
    yield Bench(board)
    board.close()


@pytest.fixture(params=[*Implementation], ids=str)
def implementation(request: pytest.FixtureRequest) -> Implementation:
    """Each of the ways in which a board's firmware runs."""
    return Implementation(request.param)
