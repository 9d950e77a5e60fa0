"""A few seconds of what `make campaign` does at length: no crash, no motion, memory flat."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from giraff_schemas.params import ParamAnswer
from giraff_schemas.topics import Query, Topic
from tests.fuzz.boards import BOARDS, fuzz_board, require_harmless
from tests.fuzz.hosts import fuzz_host_side
from tests.fuzz.keys import KEYS, fuzz_key
from tests.fuzz.network import fuzz_network
from tests.fuzz.param_keys import fuzz_param_key
from tests.fuzz.params import PARAM_KEYS
from tests.support.process_robot import process_robot
from tests.timing.faults import ARENA

BOARD_BYTES = 300_000
HOST_BYTES = 200_000
PAYLOADS = 3_000
PAYLOADS_OVER_THE_NETWORK = 300


@pytest.mark.parametrize("board", BOARDS)
def test_a_board_that_is_shouted_at_does_nothing(board: str) -> None:
    require_harmless(fuzz_board(board, BOARD_BYTES, seed=1))


@pytest.mark.parametrize("board", BOARDS)
def test_a_service_whose_board_has_gone_mad_asks_for_nothing(board: str) -> None:
    assert fuzz_host_side(board, HOST_BYTES, seed=1).frames > 100


@pytest.mark.parametrize("row", KEYS, ids=lambda row: row.key)
def test_a_key_full_of_rubbish_moves_nothing(row: Topic[Any] | Query[Any, Any]) -> None:
    counted = fuzz_key(row, PAYLOADS, seed=1)
    assert counted.driven_ms == 0
    assert counted.sound > PAYLOADS // 50, "some of it is well-formed"


@pytest.mark.parametrize("query", PARAM_KEYS, ids=lambda query: query.key)
def test_rubbish_asked_of_parameters_loosens_none(query: Query[Any, ParamAnswer]) -> None:
    counted = fuzz_param_key(query, PAYLOADS, seed=1)
    assert counted.driven_ms == 0
    assert counted.sound > PAYLOADS // 50, "some of it is well-formed"


def test_rubbish_over_the_network_moves_no_real_robot(tmp_path: Path) -> None:
    with process_robot(tmp_path, ARENA) as robot:
        fuzz_network(robot, PAYLOADS_OVER_THE_NETWORK, seed=1)
