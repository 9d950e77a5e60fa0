"""A serial port that a test stands behind, and a link to a ranger's board at it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_node.boards.board_link import BoardLink
from giraff_schemas.boards import RANGER_BOARD
from tests.unit.node.ports import FakePort


@pytest.fixture
def port(tmp_path: Path) -> Iterator[FakePort]:
    fake = FakePort(tmp_path / "board")
    yield fake
    fake.close()


@pytest.fixture
def ranger(port: FakePort) -> Iterator[BoardLink]:
    link = BoardLink(str(port.link), RANGER_BOARD)
    assert link.poll(0.0) == []
    yield link
    link.close()
