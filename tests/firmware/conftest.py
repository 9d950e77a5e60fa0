"""The boards on the bench."""

from collections.abc import Iterator

import pytest

from giraff_schemas.wire import BoardKind
from tests.firmware.bench import BaseBench, Bench, SpeedBench
from tests.firmware.builds import compiled, open_board


@pytest.fixture
def base() -> Iterator[BaseBench]:
    """A base board that was powered on 15 ms ago."""
    board = open_board(BoardKind.BASE, compiled())
    yield BaseBench(board)
    board.close()


@pytest.fixture
def robot() -> Iterator[SpeedBench]:
    """A base board that was powered on 15 ms ago, with wheels that turn by what their motors get."""
    board = open_board(BoardKind.BASE, compiled())
    yield SpeedBench(board)
    board.close()


@pytest.fixture
def joystick() -> Iterator[Bench]:
    board = open_board(BoardKind.JOYSTICK, compiled())
    yield Bench(board)
    board.close()


@pytest.fixture
def ranger() -> Iterator[Bench]:
    board = open_board(BoardKind.RANGER, compiled())
    yield Bench(board)
    board.close()
