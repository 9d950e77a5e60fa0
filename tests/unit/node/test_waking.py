"""What makes a turn of a node due, and what does not."""

import fcntl
import os
import resource
from collections.abc import Callable, Iterator
from typing import Any, cast

import pytest

from giraff_core.io import Paced
from giraff_core.timer import Timer
from giraff_node import Node
from giraff_node.process.selector import wait_for
from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.messages import Tick
from giraff_schemas.topics import TICK, Topic


class FakeProcess:
    """Turns never, and knows what for."""

    def __init__(self) -> None:
        self.watched: tuple[Any, ...] = ()
        self.wakes = 0

    def turns(self, *timers: Paced, link: object, boards: list[object] | None = None, **_: object) -> Iterator[float]:
        self.watched = (*timers, link, *(boards or ()))
        return iter(())

    def wake(self) -> None:
        self.wakes += 1


class FakeNode(Node[Any]):
    """Has no session: what arrives is said here."""

    def __init__(self) -> None:
        self.process = FakeProcess()
        self._process = cast(Any, self.process)
        self._boards = []
        self.callbacks: list[Callable[[Any], None]] = []

    def subscribe(self, topic: Topic[Any], callback: Callable[[Any], None]) -> None:  # noqa: ARG002  whichever
        self.callbacks.append(callback)


def test_the_loop_knows_which_link_is_a_board() -> None:
    node = FakeNode()
    timer, link = Timer(50.0), node.board("board", BASE_BOARD)
    assert list(node.turns(timer, link=link)) == []
    assert node.process.watched == (timer, link, link)


def test_a_sample_makes_one_due_and_is_there() -> None:
    node = FakeNode()
    inbox = node.inbox(TICK)
    tick = Tick(epoch=1, robot_ns=2)
    for callback in node.callbacks:
        callback(tick)
    assert node.process.wakes == 1
    assert list(inbox.pop_all()) == [tick]


class Pipe:
    """Readable, at a descriptor that select does not serve."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def descriptor(self) -> int:
        return self._descriptor


@pytest.mark.parametrize("says", [b"", b"x"], ids=["silent", "readable"])
def test_a_process_of_many_descriptors_waits_as_any_other(says: bytes) -> None:
    most, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(most, 1100), hard))
    ours, theirs = os.pipe()
    far = fcntl.fcntl(ours, fcntl.F_DUPFD_CLOEXEC, 1024)
    try:
        os.write(theirs, says)
        pipe = Pipe(far)
        assert wait_for([pipe], 0.0) == ({pipe} if says else set())
    finally:
        for descriptor in (ours, theirs, far):
            os.close(descriptor)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
