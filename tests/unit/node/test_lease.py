"""The operator's side of the lease: when it asks, what its commands carry, and what it tells its human."""

import pytest

from giraff_core.lease import ASK, LeaseClient
from giraff_schemas.messages import Lease
from giraff_schemas.trouble import NO_TROUBLE, Trouble


def lease(holder: str, counter: int = 0, seq: int = 0, guard: str = "guard-1", reason: str = "as it is") -> Lease:
    return Lease(seq=seq, instance=guard, holder=holder, operator="joystick", counter=counter, reason=Trouble(reason))


@pytest.fixture
def seeker() -> LeaseClient:
    return LeaseClient("me")


@pytest.fixture
def lost(seeker: LeaseClient) -> LeaseClient:
    """One that held the lease 5 and lost it."""
    seeker.on_lease(lease("me", 5, seq=1))
    seeker.on_lease(lease("", 0, seq=2, reason="nobody drives"))
    return seeker


@pytest.mark.parametrize("wishes", [False, True])
def test_it_asks_from_its_start_until_it_is_given_the_lease(seeker: LeaseClient, wishes: bool) -> None:
    assert seeker.counter(wishes=wishes) == ASK
    assert "check that giraff_guard runs" in str(seeker.refusal)
    seeker.on_lease(lease("other", 4, seq=1, reason="held by keyboard"))
    assert seeker.counter(wishes=wishes) == ASK
    assert seeker.refusal == Trouble("held by keyboard")
    seeker.on_lease(lease("me", 5, seq=2))
    assert seeker.counter(wishes=wishes) == 5
    assert (seeker.holds, seeker.refusal) == (True, NO_TROUBLE)


def test_a_lost_lease_is_asked_for_by_each_wish_and_by_nothing_else(lost: LeaseClient) -> None:
    assert lost.refusal == Trouble("nobody drives")
    for _ in range(3):
        assert lost.counter(wishes=False) == 5
        assert lost.counter(wishes=True) == ASK
        lost.on_lease(lease("other", 6, seq=3, reason="held by keyboard"))
        assert lost.refusal == Trouble("held by keyboard")
    lost.on_lease(lease("", 0, seq=4))
    assert lost.counter(wishes=False) == 5  # an old wish does not ask for what has become free


def test_a_new_lease_of_ones_own_is_taken_up(lost: LeaseClient) -> None:
    lost.on_lease(lease("me", 9, seq=3))
    assert lost.counter(wishes=True) == lost.counter(wishes=False) == 9


def test_a_late_word_of_the_guard_changes_nothing(lost: LeaseClient) -> None:
    lost.on_lease(lease("me", 5, seq=1))
    assert not lost.holds
    assert lost.refusal == Trouble("nobody drives")


def test_a_false_word_from_the_future_does_not_make_deaf_for_good(seeker: LeaseClient) -> None:
    seeker.on_lease(lease("other", 4, seq=1 << 60))
    seeker.on_lease(lease("me", 5, seq=7))
    assert seeker.holds


def test_another_guards_word_counts_from_its_first_sample(seeker: LeaseClient) -> None:
    seeker.on_lease(lease("me", 5, seq=10))
    seeker.on_lease(lease("", 0, seq=0, guard="guard-2"))
    assert not seeker.holds
    assert seeker.counter(wishes=False) == 5
    assert seeker.counter(wishes=True) == ASK
