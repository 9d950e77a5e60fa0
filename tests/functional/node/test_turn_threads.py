"""Turns that a sample's own thread makes, by threads that change places wherever they can."""

import contextlib
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from giraff_core.io import Inbox
from giraff_core.timer import Timer
from giraff_node.process import lifecycle
from giraff_node.process.lifecycle import Process
from tests.support.turning import turning_process

_ROUNDS = 500
_THREADS = 3


class Subscribers:
    """Threads as Zenoh has them: in each round each says one sample at the same moment, and waits for its turn."""

    def __init__(self, process: Process) -> None:
        self.taken = 0
        self.overlaps = 0
        self._process = process
        self._inbox: Inbox[int] = Inbox(10)
        self._inside = 0
        self._meet = threading.Barrier(_THREADS, timeout=5.0)
        self.threads = [threading.Thread(target=self._say) for _ in range(_THREADS)]

    def turn(self, _now: float) -> None:
        self._inside += 1
        self.overlaps += self._inside != 1
        self.taken += sum(1 for _ in self._inbox.pop_all())
        time.sleep(0.0)  # what comes now is for the next turn
        self._inside -= 1

    def _say(self) -> None:
        with contextlib.suppress(threading.BrokenBarrierError):
            for number in range(1, _ROUNDS + 1):
                self._meet.wait()
                self._inbox.accept(number)
                self._process.wake()
                self._await(number * _THREADS)
        self._process.leave()

    def _await(self, taken: int) -> None:
        until = time.monotonic() + 2.0  # another thread may hold the last turn
        while self.taken < taken:
            if time.monotonic() > until:
                self._meet.abort()
                raise threading.BrokenBarrierError
            time.sleep(0.0)


@pytest.fixture(autouse=True)
def _threads_change_places() -> Iterator[None]:
    kept = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(kept)


def test_no_sample_is_left_behind_and_no_turn_begins_within_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lifecycle, "_LONGEST_WAIT", 1e3)  # nothing but a wake brings a turn
    with turning_process() as process:
        said = Subscribers(process)
        timer = Timer(0.001)  # Hz
        for now in process.turns(timer, prompt=said.turn):
            if timer.due(now):  # at the start alone
                for thread in said.threads:
                    thread.start()
            said.turn(now)
        for thread in said.threads:
            thread.join()
    assert said.taken == _ROUNDS * _THREADS
    assert not said.overlaps
