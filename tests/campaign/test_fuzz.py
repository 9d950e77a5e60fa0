"""Ten million bytes at each serial link and a million payloads at each key: no crash, no motion, memory flat."""

from collections.abc import Iterator
from typing import Any

import msgspec
import pytest

from giraff_schemas.params import ParamAnswer
from giraff_schemas.topics import Query, Topic
from tests.firmware.test_noise import throw_noise
from tests.fuzz.board import BOARDS, require_harmless
from tests.fuzz.boards import fuzz_board
from tests.fuzz.growth import LIMIT, Growth
from tests.fuzz.hosts import fuzz_host_side
from tests.fuzz.keys import KEYS, Counted, fuzz_key
from tests.fuzz.param_keys import fuzz_param_key
from tests.fuzz.params import PARAM_KEYS
from tests.support.report import report

BYTES = 10_000_000
PAYLOADS = 1_000_000
SEED = 2


@pytest.fixture(scope="module")
def figures() -> Iterator[dict[str, Any]]:
    """What was counted, reported when it is all."""
    made: dict[str, Any] = {"boards": {}, "host_side": {}, "keys": {}}
    yield made
    if (len(made["boards"]), len(made["host_side"]), len(made["keys"])) == (3, 3, len(KEYS) + len(PARAM_KEYS)):
        report("campaign/fuzz", made)


@pytest.mark.parametrize("board", BOARDS)
def test_ten_million_bytes_at_a_board(board: str, figures: dict[str, Any]) -> None:
    counted = fuzz_board(board, BYTES, SEED)
    figures["boards"][board] = msgspec.to_builtins(counted)
    require_harmless(counted)


def test_ten_minutes_of_noise_at_each_board() -> None:
    throw_noise(600_000)


@pytest.mark.parametrize("board", BOARDS)
def test_ten_million_bytes_from_a_board(board: str, figures: dict[str, Any]) -> None:
    counted = fuzz_host_side(board, BYTES, SEED, Growth())
    figures["host_side"][board] = msgspec.to_builtins(counted)
    assert counted.growth_bytes < LIMIT, counted


@pytest.mark.parametrize("row", KEYS, ids=lambda row: row.key)
def test_a_million_payloads_at_a_key(row: Topic[Any] | Query[Any, Any], figures: dict[str, Any]) -> None:
    _require_harmless(figures, row.key, fuzz_key(row, PAYLOADS, SEED))


@pytest.mark.parametrize("query", PARAM_KEYS, ids=lambda query: query.key)
def test_a_million_requests_of_parameters(query: Query[Any, ParamAnswer], figures: dict[str, Any]) -> None:
    _require_harmless(figures, query.key, fuzz_param_key(query, PAYLOADS, SEED))


def _require_harmless(figures: dict[str, Any], key: str, counted: Counted) -> None:
    figures["keys"][key] = msgspec.to_builtins(counted)
    assert counted.driven_ms == 0, counted
    assert counted.growth_bytes < LIMIT, counted
