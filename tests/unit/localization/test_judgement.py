"""Whether it is known where the robot is."""

from typing import Any

import pytest

from giraff_core.kinematics.calibration import EXACTLY
from giraff_core.kinematics.pose import Pose
from giraff_localization.clusters import Cluster
from giraff_localization.judgement import Fits, Judgement
from giraff_localization.track import Stride
from giraff_schemas.trouble import NO_TROUBLE

HERE, THERE = Pose(1.0, 1.0, 0.0), Pose(4.0, 1.0, 0.0)


STRIDE = Stride(x=0.1, y=0.0, turn=0.0, forward=0.1, way=0.1, turned=0.0, missed=(0.0, 0.0))


def cluster(pose: Pose = HERE, mass: float = 0.99, spread: float = 0.1) -> Cluster:
    return Cluster(pose, mass, spread, EXACTLY)


GOOD: dict[str, Any] = {
    "found": [cluster()],
    "rivals": [cluster()],
    "fits": Fits(0.9, 0.9),
    "lead": 5.0,
    "equivalents": [],
}


def drive(judgement: Judgement, metres: float, **changed: Any) -> None:
    for _ in range(round(metres / 0.1)):
        judgement.judge(**(GOOD | changed), stride=STRIDE)


def said(judgement: Judgement) -> str:
    return judgement.state


def known(*, was_told: bool = False) -> Judgement:
    judgement = Judgement(was_told=was_told)
    drive(judgement, 4.0)
    assert judgement.state == "localized"
    return judgement


@pytest.fixture
def judgement() -> Judgement:
    return Judgement(was_told=False)


def test_it_takes_three_metres_on_which_all_agrees(judgement: Judgement) -> None:
    drive(judgement, 2.9)
    assert said(judgement) == "lost"
    assert "not found yet" in str(judgement.reason)
    drive(judgement, 0.3)
    assert (said(judgement), judgement.reason, judgement.way) == ("localized", NO_TROUBLE, 0.0)


def test_where_somebody_has_told_it_two_metres_are_enough_and_no_challenger_needed() -> None:
    judgement = Judgement(was_told=True)
    assert said(judgement) == "told"
    drive(judgement, 1.9, rivals=[])
    assert said(judgement) == "told"
    assert "checked" in str(judgement.reason)
    drive(judgement, 0.3, rivals=[])
    assert judgement.state == "localized"


@pytest.mark.parametrize(
    "wrong",
    [
        {"found": []},
        {"found": [cluster(mass=0.9), cluster(THERE, mass=0.1)]},
        {"found": [cluster(spread=0.4)]},
        {"fits": Fits(0.65, 0.9)},
        {"fits": Fits(0.9, 0.4)},
        {"fits": Fits(0.9, 0.9, unheard=3.1)},
        {"lead": -0.6},
        {"rivals": []},
        {"rivals": [cluster(THERE)]},
        {"rivals": [cluster(mass=0.8), cluster(THERE, mass=0.2)]},
        {"equivalents": [THERE]},
    ],
    ids=str,
)
def test_one_thing_that_does_not_agree_is_enough_against_it(judgement: Judgement, wrong: dict[str, Any]) -> None:
    drive(judgement, 20.0, **wrong)
    assert judgement.state != "localized"
    assert judgement.reason


@pytest.mark.parametrize(
    ("against", "metres"),
    [
        ({"found": []}, 0.1),
        ({"found": [cluster(mass=0.7)]}, 0.1),
        ({"found": [cluster(mass=0.7), cluster(THERE, mass=0.3)]}, 0.1),
        ({"found": [cluster(spread=0.8)]}, 0.1),
        ({"lead": -1.5}, 0.1),
        ({"equivalents": [THERE]}, 0.1),
        ({"fits": Fits(0.9, 0.4)}, 0.6),
        ({"fits": Fits(0.9, 0.9, unheard=3.1)}, 0.6),
        ({"fits": Fits(0.65, 0.9)}, 5.1),
    ],
    ids=str,
)
def test_a_place_that_was_told_is_driven_by_until_something_speaks_against_it(
    against: dict[str, Any], metres: float
) -> None:
    """Each ends it for good. What only does not confirm it ends it after five metres."""
    judgement = Judgement(was_told=True)
    drive(judgement, metres - 0.1, **against)
    assert said(judgement) == "told"
    drive(judgement, 0.1, **against)
    assert said(judgement) in ("lost", "ambiguous")
    assert "checked" not in str(judgement.reason)
    drive(judgement, 1.0, rivals=[])
    assert said(judgement) != "told"
    drive(judgement, 20.0, **against)
    assert said(judgement) != "localized"


def test_what_does_not_hold_for_three_metres_at_once_does_not_count(judgement: Judgement) -> None:
    for _ in range(10):
        drive(judgement, 2.0)
        drive(judgement, 0.1, fits=Fits(0.6, 0.6))
    assert judgement.state == "lost"


@pytest.mark.parametrize(
    "wrong",
    [
        {"found": []},
        {"found": [cluster(mass=0.7)]},
        {"found": [cluster(spread=0.7)]},
        {"fits": Fits(0.9, 0.4)},
        {"lead": -1.5},
    ],
    ids=str,
)
def test_one_of_them_is_enough_to_doubt_what_was_known(wrong: dict[str, Any]) -> None:
    judgement = known()
    drive(judgement, 0.1, **wrong)
    assert judgement.state == "lost"
    assert "carried away" in str(judgement.reason)


@pytest.mark.parametrize(
    "bearable", [{"fits": Fits(0.5, 0.5)}, {"found": [cluster(mass=0.85)]}, {"lead": -0.9}], ids=str
)
def test_what_is_known_is_not_given_up_for_a_little(bearable: dict[str, Any]) -> None:
    judgement = known()
    drive(judgement, 5.0, **bearable)
    assert judgement.state == "localized"


def test_where_no_sensor_says_anything_nothing_is_known() -> None:
    judgement = known()
    drive(judgement, 0.1, fits=Fits(0.9, 0.9, unheard=3.1))
    assert judgement.state == "lost"
    assert "giraff_ranger" in str(judgement.reason)


def test_on_a_map_that_has_explained_little_for_long_no_place_is_believed_soon(judgement: Judgement) -> None:
    drive(judgement, 30.0, fits=Fits(0.4, 0.4))
    drive(judgement, 5.0)
    assert judgement.state == "lost"


def test_told_once_it_is_found_again_only_as_any_other() -> None:
    judgement = known(was_told=True)
    drive(judgement, 0.1, fits=Fits(0.0, 0.0))
    drive(judgement, 20.0, rivals=[])
    assert judgement.state == "lost"


def test_another_cloud_begins_anew() -> None:
    judgement = known(was_told=True)
    judgement.begin_anew()
    drive(judgement, 2.0)
    assert judgement.state == "lost"


@pytest.mark.parametrize("there", [THERE, Pose(1.4, 1.0, 3.1)], ids=["elsewhere", "turned round nearby"])
def test_several_places_are_ambiguous_best_first(judgement: Judgement, there: Pose) -> None:
    drive(judgement, 1.0, found=[cluster(mass=0.6), cluster(there, mass=0.3)])
    assert judgement.state == "ambiguous"
    assert [(place.x, place.belief) for place in judgement.candidates] == [(1.0, 0.6), (there.x, 0.3)]
    assert judgement.others == [there]
    assert "2 places fit" in str(judgement.reason)


def test_a_twin_is_a_candidate_that_no_particle_believes(judgement: Judgement) -> None:
    drive(judgement, 1.0, equivalents=[THERE])
    assert judgement.state == "ambiguous"
    assert judgement.candidates[1].belief == 0.0
    assert judgement.others == [], "which do not become equivalent places again"


def test_places_that_explain_little_are_no_candidates_to_choose_from(judgement: Judgement) -> None:
    drive(judgement, 1.0, found=[cluster(mass=0.6), cluster(THERE, mass=0.3)], fits=Fits(0.5, 0.5))
    assert judgement.state == "lost"
    assert len(judgement.candidates) == 2


def test_the_map_is_doubted_after_forty_metres_on_which_no_place_fits(judgement: Judgement) -> None:
    drive(judgement, 39.0, fits=Fits(0.5, 0.5))
    assert "may not be the map" not in str(judgement.reason)
    drive(judgement, 2.0, fits=Fits(0.5, 0.5))
    assert "may not be the map" in str(judgement.reason)


def test_equal_rooms_are_no_reason_to_doubt_the_map(judgement: Judgement) -> None:
    drive(judgement, 60.0, equivalents=[THERE])
    assert "2 places fit" in str(judgement.reason)


def test_a_good_place_now_and_then_is_no_reason_to_believe_the_map(judgement: Judgement) -> None:
    for _ in range(5):
        drive(judgement, 8.0, fits=Fits(0.4, 0.4))
        drive(judgement, 1.0, rivals=[])
    assert "may not be the map" in str(judgement.reason)
