"""How likely each reading is."""

import numpy as np
import pytest

from giraff_localization.beams.range_table import BIN, CLEAR, SLANTED, SOLID
from giraff_localization.beams.ultrasonic import beam_model

REACH = 4.0
MODEL = beam_model(REACH, BIN)


@pytest.mark.parametrize("expected", [60, 100, 150, CLEAR, SLANTED])
def test_what_can_be_heard_adds_up_to_one(expected: int) -> None:
    likely = np.exp(MODEL[:, expected].astype(float))
    total = likely[: round(REACH / BIN)].sum() * BIN + likely[CLEAR]
    assert total == pytest.approx(1.0, abs=0.03)


def test_the_expected_echo_is_likeliest() -> None:
    assert MODEL[:CLEAR, 100].argmax() in {99, 100}


def test_something_nearer_is_likelier_than_something_farther() -> None:
    assert MODEL[20, 150] > MODEL[200, 150]


def test_nothing_is_impossible() -> None:
    assert np.isfinite(MODEL).all()


def test_within_a_wall_nothing_is_likely() -> None:
    assert MODEL[: CLEAR + 1, SOLID].max() < MODEL[: CLEAR + 1, SLANTED].min()


def test_silence_tells_the_open_from_a_wall() -> None:
    assert MODEL[CLEAR, CLEAR] > MODEL[CLEAR, SLANTED] > MODEL[CLEAR, 100]
