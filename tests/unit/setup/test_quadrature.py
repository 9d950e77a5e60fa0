"""What is wrong with an encoder is found in its transitions, named alone, and said what to do about."""

import random
from typing import Any

import pytest

from giraff_setup.encoder.advice import advice
from giraff_setup.encoder.quadrature import FEWEST, Turn, analyse
from giraff_setup.encoder.traces import Trace, drawing, traces
from giraff_setup.encoder.transitions import Transition, runs_of
from tests.support.encoder_disks import PAIRS, disk, turned


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize(
    ("made", "phase", "duties", "told"),
    [
        ({}, 90, (50, 50), ""),
        ({"phase": 75, "a": 0.55, "b": 0.45}, 75, (55, 45), ""),
        ({"phase": 60}, 60, (50, 50), "is 60 of 360 degrees, not 90; move sensor B by 0.08 of a pair"),
        ({"phase": -60}, 60, (50, 50), "is 60 of 360 degrees, not 90; move sensor B by 0.08 of a pair"),
        ({"phase": 120}, 120, (50, 50), "is 120 of 360 degrees, not 90; move sensor B by 0.08 of a pair"),
        ({"b": 0.4}, 90, (50, 40), "sensor B is high for 40 % of a pair, not 50 %: it sees its low mark too long"),
        ({"a": 0.62}, 90, (62, 50), "sensor A is high for 62 % of a pair, not 50 %: it sees its high mark too long"),
        (
            {"no_a": {7}},
            90,
            (50, 50),
            "of the ring of A one mark is missing or dirty, once in 160 states (a turn of 40",
        ),
        (
            {"no_b": {7}},
            90,
            (50, 50),
            "of the ring of B one mark is missing or dirty, once in 160 states (a turn of 40",
        ),
        ({"no_b": {7, 8}}, 90, (50, 50), "of the ring of B 2 marks are missing or dirty, once in 160 states"),
        ({"no_b": {3, 20}}, 90, (50, 50), "of the ring of B 2 marks are missing or dirty, once in 160 states"),
        ({"no_b": range(PAIRS)}, None, (50, None), "sensor B is silent: it did not change while sensor A did"),
        ({"no_a": range(PAIRS)}, None, (None, 50), "sensor A is silent: it did not change while sensor B did"),
    ],
)
def test_each_fault_is_named_alone_with_its_figure(
    made: dict[str, Any], phase: int | None, duties: tuple[int | None, ...], told: str, backward: bool
) -> None:
    figures = analyse(turned(disk(**made), backward=backward, noise_ms=0.05))
    found = [*map(str, advice(figures))]
    assert [told in each for each in found] == ([True] if told else [])
    assert figures.phase == (phase if phase is None else pytest.approx(phase, abs=1.0))
    for (_, channel), duty in zip(figures.channels, duties, strict=True):
        assert channel.duty == (duty if duty is None else pytest.approx(duty / 100, abs=0.01))
    if phase is not None:
        assert figures.leads == "BA"[(made.get("phase", 90) > 0) != backward]
    assert Trace.of(figures) is not None


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("phase", [50, 130, -50, -130])
def test_moving_sensor_b_as_is_said_puts_the_phase_right(phase: float, backward: bool) -> None:
    """A sensor that is moved the way in which a disk turns sees each mark later."""
    (told,) = map(str, advice(analyse(turned(disk(phase), backward=backward))))
    pairs = float(told.split("move sensor B by ")[1].split()[0])
    later = pairs if " with the way" in told else -pairs
    moved = phase + 360.0 * (-later if backward else later)
    assert not list(advice(analyse(turned(disk(moved), backward=backward))))


def test_marks_passed_over_at_changing_places_are_no_mark_of_the_disk() -> None:
    made = disk(no_a={20, 57, 133, 140, 260, 301}, pairs=400)
    figures = analyse(turned(made, 1, turn_ms=2000.0))
    assert (figures.a.missing, figures.a.turn) == (6, None)
    assert ["sensor A passed over 6 marks, at changing places" in str(each) for each in advice(figures)] == [True]


def test_a_channel_that_flickers_is_told_from_a_missing_mark() -> None:
    told = list[Transition]()
    for number, each in enumerate(turned(disk())):
        told.append(each)
        if number % 50 == 0 and number:
            a, b = each.levels
            told += [Transition(0.05, (not a, b)), Transition(0.05, (a, b))]
    figures = analyse(told)
    assert (figures.a.missing, figures.b.missing) == (0, 0)
    assert ["times to and fro" in str(each) for each in advice(figures)] == [True]


def test_what_came_before_a_loss_is_not_counted_on() -> None:
    """The board has lost a part of each second turn: the marks are not missing."""
    told = [
        each if number % 150 else Transition(None, each.levels)
        for number, each in enumerate(turned(disk(), turns=12))
        if number % 300 < 280
    ]
    figures = analyse(told)
    assert figures.losses == 12
    assert not list(advice(figures))


def test_a_start_that_trembles_and_an_end_that_turns_back_are_not_judged() -> None:
    good = turned(disk())
    tremble = [Transition(40.0, (number % 2 == 0, good[0].levels[1])) for number in range(11)]
    back = [Transition(3.0 + number, each.levels) for number, each in enumerate(reversed(good[-30:-1]))]
    assert not list(advice(analyse([*tremble, good[0]._replace(after_ms=30.0), *good[1:], *back])))


@pytest.mark.parametrize("count", [0, 1, 2, 3, 10, FEWEST])
def test_a_few_transitions_are_too_few(count: int) -> None:
    figures = analyse(turned(disk())[:count])
    (told,) = advice(figures)
    assert "too few changes to judge" in told.what


def test_channels_that_change_at_once_are_not_called_slow() -> None:
    """The board sees both changed, and calls what was between them a loss."""
    told = [Transition(None, (number % 2 == 0, number % 2 == 0)) for number in range(200)]
    (found,) = advice(analyse(told))
    assert "A and B change at the same moment" in found.what


def test_whatever_a_board_tells_is_judged_without_an_error() -> None:
    noise = random.Random(3)
    for count in range(60):
        told = [Transition.read(noise.randrange(1 << 16), is_torn=not noise.randrange(9)) for _ in range(5 * count)]
        told += [Transition(0.0, each.levels) for each in told]
        figures = analyse(told)
        assert all("nan" not in str(each) for each in advice(figures))
        if (trace := Trace.of(figures)) is not None:
            assert len([*traces(trace, dots=True)]) == 5


def test_words_of_the_board_are_read_as_it_writes_them() -> None:
    assert Transition.read(0xC000 | 36) == Transition(0.5, (True, True))
    assert Transition.read(0x4000 | 0x3FFF) == Transition(None, (False, True))
    assert Transition.read(0x8000, is_torn=True) == Transition(None, (True, False))
    (run,) = runs_of([Transition(None, (False, False)), Transition(0.5, (True, True))])
    assert [(edge.at, edge.channel) for edge in run.edges] == [(0.5, 0), (0.5, 1)]


def test_a_turn_is_known_from_three_passes_of_a_mark() -> None:
    assert analyse(turned(disk(no_a={30}), turns=4)).a.turn == Turn(160, 1)
    few = analyse(turned(disk(no_a={30}), turns=2)).a
    assert (few.turn, few.apart) == (None, 160)


def test_the_worst_place_is_drawn() -> None:
    trace = Trace.of(analyse(turned(disk(no_a={7}))))
    assert trace is not None
    lines = [*traces(trace, dots=False)]
    assert lines[0].startswith("  A")
    assert "#" * 16 in lines[1], "A stays low"
    assert "#" * 10 not in lines[0]
    assert lines[-1].split() == ["0", f"{trace.end - trace.begin:.3g}", "ms"]
    assert drawing([("left", trace), ("right", trace)]).count("<path") > 8
