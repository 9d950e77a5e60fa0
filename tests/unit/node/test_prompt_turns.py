"""Turns that a sample's own thread makes. Another thread is played: it finds the lock as the moment has it."""

import math
from collections.abc import Callable, Iterable

import pytest

from giraff_core.io import Selectable
from giraff_core.timer import Timer
from giraff_node.process import lifecycle
from giraff_node.process.lifecycle import Process
from tests.support.turning import turning_process


class Turning:
    """A process whose waits are played: during each wait of its loop comes the next of these acts."""

    def __init__(self, process: Process, monkeypatch: pytest.MonkeyPatch, *acts: Callable[[], None]) -> None:
        self.process = process
        self.made: list[str] = []
        """Who made each turn."""
        self.waits: list[float] = []
        self.wakes = 0
        self.during: list[Callable[[], None]] = []
        """Acts that come during turns, one each."""
        self._acts = [*acts, process.leave]
        self._timer = Timer(0.001)  # Hz; due at the start alone
        self._depth = 0
        monkeypatch.setattr(lifecycle, "wait_for", self._wait)
        monkeypatch.setattr(process._waker, "wake", self._count)

    def run(self, *, is_prompt: bool = True) -> None:
        for now in self.process.turns(self._timer, prompt=self._sample_turn if is_prompt else None):
            self._timer.due(now)
            self._turn("loop")

    def _sample_turn(self, _now: float) -> None:
        self._turn("sample")

    def _turn(self, maker: str) -> None:
        assert not self._depth
        self._depth += 1
        self.made.append(maker)
        try:
            if self.during:
                self.during.pop(0)()
        finally:
            self._depth -= 1

    def _wait(self, _watched: Iterable[Selectable], seconds: float) -> set[Selectable]:
        self.waits.append(seconds)
        if seconds and len(self.waits) > 1:  # the loop's own turn is due during the first
            self._acts.pop(0)()
        return set()

    def _count(self) -> None:
        self.wakes += 1


def test_a_sample_costs_one_turn_in_its_own_thread_and_no_wake_of_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    with turning_process() as process:
        turning = Turning(process, monkeypatch, *[process.wake] * 50)
        turning.run()
    assert turning.made.count("sample") == 50
    assert turning.wakes == 1  # to leave


@pytest.mark.parametrize("maker", ["loop", "sample"])
def test_a_sample_that_comes_during_a_turn_has_the_next_one_at_once(
    monkeypatch: pytest.MonkeyPatch, maker: str
) -> None:
    with turning_process() as process:
        turning = Turning(process, monkeypatch, process.wake)
        if maker == "sample":
            turning.during.append(lambda: None)
        turning.during.append(process.wake)
        turning.run()
    assert turning.made[:3] == (["loop", "sample", "sample"] if maker == "sample" else ["loop", "loop", "sample"])


class ContestedLock:
    """The lock of the turns. Another thread's sample comes while the loop waits for it."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._is_held = False

    def acquire(self, blocking: bool = True) -> bool:
        if blocking:
            self._process.wake()
        if self._is_held:
            assert not blocking
            return False
        self._is_held = True
        return True

    def release(self) -> None:
        self._is_held = False

    def __enter__(self) -> None:
        self._is_held = True

    def __exit__(self, *_: object) -> None:
        self._is_held = False


def test_a_loop_that_waits_for_the_lock_has_it_before_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples without end would keep it out, and its watchdog would end the process."""
    with turning_process() as process:
        turning = Turning(process, monkeypatch)
        monkeypatch.setattr(process, "_turning", ContestedLock(process))
        turning.run()
    assert turning.made[0] == "loop"
    assert "sample" not in turning.made


def test_a_turn_that_makes_the_next_one_due_sooner_wakes_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    with turning_process() as process:
        turning = Turning(process, monkeypatch, process.wake)
        turning.during += [lambda: None, lambda: monkeypatch.setattr(turning._timer, "wait", lambda _now: 0.001)]
        turning.run()
    assert turning.wakes == 2  # and to leave


@pytest.mark.parametrize("error", [ValueError("wrong"), SystemExit(3)])
def test_what_a_prompt_turn_raises_ends_the_loop_and_no_turn_follows(
    monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    def fails() -> None:
        raise error

    def say_twice() -> None:
        process.wake()
        process.wake()

    with turning_process() as process:
        turning = Turning(process, monkeypatch, say_twice)
        turning.during += [lambda: None, fails]
        with pytest.raises(type(error)):
            turning.run()
        process.wake()
    assert turning.made == ["loop", "sample"]


def test_no_turn_comes_after_one_of_the_loop_has_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails() -> None:
        raise LookupError

    with turning_process() as process:
        turning = Turning(process, monkeypatch)
        turning.during.append(fails)
        with pytest.raises(LookupError):
            turning.run()
        process.wake()
    assert turning.made == ["loop"]


def test_no_turn_comes_after_the_loop_has_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    with turning_process() as process:
        turning = Turning(process, monkeypatch)
        turning.run()
        made = [*turning.made]
        process.wake()
    assert turning.made == made


def test_a_loop_that_makes_all_turns_itself_is_woken(monkeypatch: pytest.MonkeyPatch) -> None:
    with turning_process() as process:
        turning = Turning(process, monkeypatch, process.wake)
        turning.run(is_prompt=False)
    assert turning.wakes == 2
    assert "sample" not in turning.made


class Line:
    """A board's link, in which something comes during each wait. `frames`: whether one is whole then."""

    def __init__(self, *frames: bool) -> None:
        self._frames = [*frames]
        self.looks = 0

    def descriptor(self) -> int:
        return -1

    def wait(self, _now: float) -> float:
        return math.inf

    def ready(self, _now: float) -> bool:
        self.looks += 1
        return self._frames.pop(0)


def test_a_frame_of_a_board_makes_one_turn_however_many_pieces_it_comes_in(monkeypatch: pytest.MonkeyPatch) -> None:
    line, turns = Line(False, False, True, False, True), 0
    with turning_process() as process:
        monkeypatch.setattr(lifecycle, "wait_for", lambda _watched, _seconds: {line})
        timer = Timer(0.001)
        timer.due(1e9)  # then it is due no more
        for _ in process.turns(timer, link=line, boards=[line]):
            turns += 1
            if turns == 2:
                process.leave()
    assert line.looks == 5
