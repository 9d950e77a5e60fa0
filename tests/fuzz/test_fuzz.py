"""A little of what `make campaign` does at length and under sanitizers: no crash, no motion, and it drives again.

Whether memory stays flat shows only at length. One robot takes all keys in turn, and has to drive after each eighth
and after the last.
"""

import pytest

from giraff_sim.board import BUILD
from tests.fuzz.board import BOARDS, fuzz, require_harmless
from tests.fuzz.hosts import fuzz_host_side
from tests.fuzz.keys import KEYS, Counted, armed_robot, fuzz_key_of
from tests.fuzz.param_keys import fuzz_param_key_of
from tests.fuzz.params import PARAM_KEYS

BOARD_BYTES = 100_000
HOST_BYTES = 100_000
PAYLOADS = 300
"""At each key."""
EACH = 8
"""Number of keys between two drives."""


@pytest.mark.parametrize("board", BOARDS)
def test_a_board_that_is_shouted_at_does_nothing(board: str) -> None:
    require_harmless(fuzz(BUILD / "host" / f"{board}.so", f"1/{board}", BOARD_BYTES))


@pytest.mark.parametrize("board", BOARDS)
def test_a_service_whose_board_has_gone_mad_asks_for_nothing(board: str) -> None:
    assert fuzz_host_side(board, HOST_BYTES, seed=1).frames > 100


def test_a_key_full_of_rubbish_moves_nothing() -> None:
    with armed_robot() as (loop, truths):
        counted = {
            row.key: fuzz_key_of(loop, truths, row, PAYLOADS, seed=1, drives=row in KEYS[::-EACH]) for row in KEYS
        }
    require_nothing_moved(counted)


def test_rubbish_asked_of_parameters_loosens_none() -> None:
    with armed_robot() as (loop, _):
        counted = {
            query.key: fuzz_param_key_of(loop, query, PAYLOADS, seed=1, drives=query in PARAM_KEYS[::-EACH])
            for query in PARAM_KEYS
        }
    require_nothing_moved(counted)


def require_nothing_moved(counted: dict[str, Counted]) -> None:
    assert {key: each.driven_ms for key, each in counted.items() if each.driven_ms} == {}
    shares = {key: each.sound / each.payloads for key, each in counted.items()}
    assert min(shares.values()) > 1 / 50, f"some of it is well-formed: {shares}"
