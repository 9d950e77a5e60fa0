"""Samples that make no turn due: they wait undecoded, and a turn reads them."""

from typing import Any, NamedTuple, cast

import pytest

from giraff_node.network.subscription import PolledInbox, Reader
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Tick
from giraff_schemas.topics import TICK
from giraff_schemas.trouble import Trouble

KEY = "giraff/here/tick"


class Received(NamedTuple):
    """As Zenoh gives it."""

    payload: bytes
    key_expr: str = KEY
    encoding: str = encoding_of(Tick)


class Ring(list[Received]):
    """A subscriber's ring."""

    def try_recv(self) -> Received | None:
        return self.pop(0) if self else None


def tick(number: int) -> Received:
    return Received(encode(stamped(Tick(epoch=1, robot_ns=number), number, 0, "0123456789abcdef")))


@pytest.mark.parametrize(("limit", "kept"), [(1, [4]), (3, [2, 3, 4]), (200, [1, 2, 3, 4])])
def test_a_turn_reads_what_has_come_and_keeps_the_newest(limit: int, kept: list[int]) -> None:
    told: list[str] = []
    inbox: PolledInbox[Tick] = PolledInbox(limit, Reader(TICK, KEY, lambda name, _: told.append(name)))
    ring = Ring(map(tick, (1, 2, 3, 4)))
    inbox.subscriber = cast(Any, ring)
    assert [each.robot_ns for each in inbox.pop_all()] == kept
    assert not list(inbox.pop_all())
    assert not told


def test_rubbish_is_told_and_pushes_nothing_out() -> None:
    told: list[tuple[str, Trouble]] = []
    inbox: PolledInbox[Tick] = PolledInbox(1, Reader(TICK, KEY, lambda *news: told.append(news)))
    ring = Ring((tick(1), *[Received(b"rubbish")] * 250))
    inbox.subscriber = cast(Any, ring)
    assert [each.robot_ns for each in inbox.pop_all()] == [1]
    assert [name for name, _ in told] == [f"decode {KEY}"]


def test_a_flood_does_not_hold_the_turn() -> None:
    inbox: PolledInbox[Tick] = PolledInbox(200, Reader(TICK, KEY, lambda *_: None))

    class Flood(Ring):
        taken = 0

        def try_recv(self) -> Received:
            self.taken += 1
            return tick(self.taken)

    flood = Flood()
    inbox.subscriber = cast(Any, flood)
    assert len(list(inbox.pop_all())) == 200
    assert flood.taken == 300
