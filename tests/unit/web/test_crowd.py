"""Who goes where a crowd is too large."""

from giraff_web.limits import Allowance
from giraff_web.server.crowd import Crowd


class Caller:
    def __init__(self, address: str, since: float, *, is_busy: bool = False) -> None:
        self.address, self.since, self.is_busy = address, since, is_busy
        self.ended = False

    def end(self) -> None:
        self.ended = True


def crowd(*callers: Caller) -> Crowd[Caller]:
    it: Crowd[Caller] = Crowd(Allowance(most=4, of_one_address=3, patience=5.0))
    assert all(it.enter(each) for each in callers)
    return it


def test_the_oldest_of_the_address_with_the_most_goes() -> None:
    callers = [Caller("a", 0.0), Caller("b", 2.0), Caller("b", 1.0), Caller("c", 3.0)]
    it = crowd(*callers)
    assert it.enter(Caller("d", 4.0))
    assert [each.ended for each in callers] == [False, False, True, False]
    assert len(it) == 4


def test_an_address_that_has_too_many_makes_room_itself() -> None:
    callers = [Caller("a", 1.0), Caller("b", 0.0), Caller("a", 2.0), Caller("a", 3.0)]
    assert crowd(*callers).enter(Caller("a", 4.0))
    assert [each.ended for each in callers] == [True, False, False, False]


def test_a_busy_one_never_goes_and_counts_for_no_address() -> None:
    callers = [Caller("a", 0.0, is_busy=True), Caller("a", 1.0, is_busy=True), Caller("a", 2.0), Caller("b", 1.5)]
    it = crowd(*callers)
    assert it.enter(Caller("c", 3.0, is_busy=True))
    assert [each.ended for each in callers] == [False, False, False, True]
    callers[2].is_busy = True
    assert not it.enter(Caller("d", 4.0))
    it.end_late(100.0)
    assert len(it) == 4


def test_one_that_does_nothing_for_too_long_ends() -> None:
    callers = [Caller("a", 0.0), Caller("b", 0.1)]
    it = crowd(*callers)
    it.end_late(5.0)
    assert [each.ended for each in callers] == [True, False]
    assert len(it) == 1
