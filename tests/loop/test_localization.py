"""Localization on drives through the simulated world, without boards: what tests/campaign does to many, once each."""

import math
from collections import deque
from typing import Final, NamedTuple

import msgspec
import pytest

from giraff_localization.config import LocalizationConfig
from giraff_schemas.messages import Odometry
from giraff_sim.world.room import Pose
from tests.loop.localization.drives import Drive, Variation, drive
from tests.loop.localization.judging import Row, Run, rows, verdict
from tests.loop.localization.kinds import KINDS, policy

CONFIG: Final = LocalizationConfig(most_particles=5_000)
_TRACKED: Final = Variation("living_room", metres=20.0)
_KIDNAPPED: Final = Variation("living_room", metres=16.0, kidnapped_after=4.0)
_TWIN: Final = KINDS["twin"].variation._replace(metres=4.0)
_SEED: Final = 1
_NOT_LATER_KIDNAPPED: Final = 7
"""A seed that adds no way to what it is kidnapped after."""
_PART: Final = 5.0  # m
_BEGINS_ANEW: Final = 4.0  # m
_SET_ELSEWHERE: Final = 6.0  # m
_ELSEWHERE: Final = Pose(3.0, -2.0, 2.0)


class Followed(NamedTuple):
    """A drive of 20 m, followed from a known place."""

    drive: Drive
    rows: list[Row]
    entries: list[int]
    """Of all that the policy keeps, after each 5 m."""


@pytest.fixture(scope="module")
def followed() -> Followed:
    driven, looks = drive(_TRACKED, _SEED), policy("living_room", _SEED, CONFIG)
    found, entries = [], []
    for number in range(round(_TRACKED.metres / _PART)):
        part = [moment for moment in driven.moments if number <= moment.path / _PART < number + 1]
        found += rows(driven._replace(moments=part), looks, tracks=number == 0)
        entries.append(_entries(looks))
    return Followed(driven, found, entries)


def test_it_follows_a_robot_whose_place_is_known(followed: Followed) -> None:
    found = verdict([Run(_SEED, followed.rows, None)], tracks=True)
    assert found.median <= 0.10
    assert found.p95 <= 0.25
    assert found.localized >= 0.85
    assert not found.wrong_runs


def test_what_it_keeps_does_not_grow_with_the_way(followed: Followed) -> None:
    assert followed.entries[-1] <= 1.5 * followed.entries[0]


def test_it_knows_that_it_may_be_in_the_other_one_of_two_equal_rooms() -> None:
    run = Run(_SEED, rows(drive(_TWIN, _SEED), policy("twins", _SEED, CONFIG)), None)
    found = verdict([run])
    assert found.localized == 0.0
    assert found.ambiguous >= 0.5
    assert found.near_while_ambiguous >= 0.95


def test_it_notices_that_it_was_carried_away_and_finds_itself_again() -> None:
    driven = drive(_KIDNAPPED, _NOT_LATER_KIDNAPPED)
    run = Run(_SEED, rows(driven, policy("living_room", _SEED, CONFIG), tracks=True), driven.kidnapped_at)
    assert run.quiet <= 5.0
    assert run.again < math.inf
    assert not run.wrong


def test_odometry_that_leaps_moves_the_robot_nowhere(followed: Followed) -> None:
    driven = followed.drive
    moments = [moment for moment in driven.moments if moment.path <= _SET_ELSEWHERE + 2.0]
    restart = next(
        moment.message for moment in moments if moment.path >= _BEGINS_ANEW and isinstance(moment.message, Odometry)
    )
    anew = _frame_of(restart)

    def told(odometry: Odometry, path: float) -> Odometry:
        if path < _BEGINS_ANEW:
            return odometry
        odometry = msgspec.structs.replace(_moved(odometry, anew), instance="another")
        if path < _SET_ELSEWHERE:
            return odometry
        return msgspec.structs.replace(_moved(odometry, _ELSEWHERE), jumps=1)

    leaping = [
        moment._replace(message=told(moment.message, moment.path)) if isinstance(moment.message, Odometry) else moment
        for moment in moments
    ]
    looks = policy("living_room", _SEED, CONFIG)
    found = rows(driven._replace(moments=leaping), looks, tracks=True)
    assert max(row.error for row in found) <= 0.5
    assert {row.state for row in found if row.path > _SET_ELSEWHERE + 1.0} == {"localized"}
    assert math.dist((looks.pose().odom.x, looks.pose().odom.y), moments[0].truth[:2]) > 1.0


def _moved(odometry: Odometry, place: Pose) -> Odometry:
    """The same as if its frame lay elsewhere."""
    cos, sin = math.cos(place.yaw), math.sin(place.yaw)
    return msgspec.structs.replace(
        odometry,
        x=place.x + cos * odometry.x - sin * odometry.y,
        y=place.y + sin * odometry.x + cos * odometry.y,
        yaw=math.remainder(place.yaw + odometry.yaw, math.tau),
    )


def _frame_of(odometry: Odometry) -> Pose:
    """Where a frame lies in which this pose is zero."""
    cos, sin = math.cos(odometry.yaw), math.sin(odometry.yaw)
    return Pose(-cos * odometry.x - sin * odometry.y, sin * odometry.x - cos * odometry.y, -odometry.yaw)


def _entries(root: object) -> int:
    """Of all that can grow in it, however deep: arrays count as one."""
    seen: set[int] = set()
    waiting, count = [root], 0
    while waiting:
        each = waiting.pop()
        if id(each) in seen:
            continue
        seen.add(id(each))
        inner: list[object] = []
        if isinstance(each, dict):
            inner = [*each.values()]
        elif isinstance(each, list | tuple | deque | set | frozenset):
            inner = [*each]
        elif type(each).__module__.startswith("giraff_"):
            inner = [*getattr(each, "__dict__", {}).values()]
            inner += [getattr(each, name, None) for name in getattr(type(each), "__struct_fields__", ())]
        count += len(inner)
        waiting += inner
    return count
