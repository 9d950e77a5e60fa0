"""Turns that a sample's own thread makes: none is lost, none overlaps, and what goes wrong in one ends the process."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import cast

import pytest

from giraff_core.inbox import Inbox
from giraff_core.timer import PromptTimer, Timer
from giraff_node.process import lifecycle
from giraff_node.process.lifecycle import Process
from giraff_node.process.selector import Waker


def never() -> PromptTimer:
    """Return a timer that has just had its turn, and has no other for a long time."""
    timer = PromptTimer(0.001)
    timer.due(time.monotonic())
    return timer


class CountingWaker(Waker):
    """Knows how often the loop was woken."""

    wakes = 0

    def wake(self) -> None:
        self.wakes += 1
        super().wake()


@pytest.fixture
def process(monkeypatch: pytest.MonkeyPatch) -> Iterator[Process]:
    kept = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    switch = sys.getswitchinterval()
    monkeypatch.setattr(lifecycle, "Waker", CountingWaker)
    process = Process("under_test")
    try:
        yield process
    finally:
        signal.set_wakeup_fd(-1)
        process._waker.close()
        sys.setswitchinterval(switch)
        for number, handler in kept.items():
            signal.signal(number, handler)


def quiet_loop(process: Process, prompt: Callable[[float], None], *timers: Timer) -> list[str]:
    """Run the loop to its end; return the names of the threads of the turns that it made itself."""
    made: list[str] = []
    for now in process.turns(*timers, prompt=prompt):
        made.append(threading.current_thread().name)
        prompt(now)
    return made


def test_no_sample_is_left_behind_and_no_turn_begins_within_another(
    process: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lifecycle, "_LONGEST_WAIT", 1e3)  # nothing but a wake brings a turn
    sys.setswitchinterval(1e-6)  # threads change places wherever they can
    inbox: Inbox[int] = Inbox(10)
    rounds, threads = 500, 3
    taken, inside, overlaps = [0], [0], [0]
    meet = threading.Barrier(threads, timeout=5.0)

    def turn(_now: float) -> None:
        inside[0] += 1
        overlaps[0] += inside[0] != 1
        taken[0] += sum(1 for _ in inbox.take())
        time.sleep(0.0)  # what comes now is for the next turn
        inside[0] -= 1

    def say() -> None:
        for number in range(1, rounds + 1):
            with contextlib.suppress(threading.BrokenBarrierError):
                meet.wait()
            inbox.accept(number)
            process.wake()
            until = time.monotonic() + 2.0  # another thread may hold the last turn
            while taken[0] < number * threads and time.monotonic() < until:
                time.sleep(0.0)
            if taken[0] < number * threads:
                break
        meet.abort()
        process.leave()

    first = while_it_waits(process, say)
    others = [threading.Thread(target=say) for _ in range(threads - 1)]
    for thread in others:
        thread.start()
    quiet_loop(process, turn, never())
    for thread in (first, *others):
        thread.join()
    assert taken[0] == rounds * threads
    assert not overlaps[0]


def test_a_sample_that_comes_during_a_turn_of_the_loop_has_the_next_one(
    process: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lifecycle, "_LONGEST_WAIT", 1e3)
    turns = 0
    patience = threading.Timer(5.0, process.leave)
    patience.start()
    timer = Timer(0.001)
    for now in process.turns(timer, prompt=lambda _now: None):
        timer.due(now)
        turns += 1
        if turns == 2:
            process.leave()
            break
        sample = threading.Thread(target=process.wake)
        sample.start()
        sample.join()
    patience.cancel()
    assert turns == 2


def wakes_of(process: Process) -> int:
    return cast(CountingWaker, process._waker).wakes


def while_it_waits(process: Process, act: Callable[[], None]) -> threading.Thread:
    """Start a thread that acts once the loop waits."""

    def wait_and_act() -> None:
        while process._turning.locked() or not process._waits_until:
            time.sleep(0.001)
        act()

    thread = threading.Thread(target=wait_and_act, name="sample")
    thread.start()
    return thread


def test_a_sample_costs_one_turn_in_its_own_thread_and_no_wake_of_the_loop(process: Process) -> None:
    """Counts, so that they are the same on every machine: the loop turns for its timer alone."""
    made_by: list[str] = []

    def say() -> None:
        for _ in range(50):
            process.wake()
        wakes.append(wakes_of(process))
        process.leave()

    wakes: list[int] = []
    thread = while_it_waits(process, say)
    own = quiet_loop(process, lambda _now: made_by.append(threading.current_thread().name), never())
    thread.join()
    assert wakes == [0]
    # A turn of the loop may come between: it wakes ten times a second, and takes a sample's turn along.
    assert made_by.count("sample") + len(own) >= 50
    assert made_by.count("sample") >= 40


def test_a_turn_that_makes_the_next_one_due_sooner_wakes_the_loop(process: Process) -> None:
    timer = never()
    turns: list[str] = []

    def turn(now: float) -> None:
        name = threading.current_thread().name
        if timer.due(now) and name == threading.main_thread().name and "sample" in turns:
            process.leave()
        turns.append(name)
        if name == "sample":
            timer.hurry("again", now + 0.005)

    thread = while_it_waits(process, process.wake)
    quiet_loop(process, turn, timer)
    thread.join()
    assert wakes_of(process) == 2  # for the earlier moment, and to leave


@pytest.mark.parametrize("error", [ValueError("wrong"), SystemExit(3)])
def test_what_a_prompt_turn_raises_ends_the_loop_and_no_turn_follows(process: Process, error: BaseException) -> None:
    turns: list[str] = []

    def turn(_now: float) -> None:
        turns.append(threading.current_thread().name)
        if turns[-1] == "sample":
            raise error

    def say_twice() -> None:
        process.wake()
        process.wake()

    thread = while_it_waits(process, say_twice)
    with pytest.raises(type(error)):
        quiet_loop(process, turn, never())
    thread.join()
    process.wake()
    assert turns.count("sample") == 1


def test_no_turn_comes_after_the_loop_has_ended(process: Process) -> None:
    turns: list[float] = []
    process.leave()
    quiet_loop(process, turns.append, never())
    process.wake()
    assert not turns


def test_a_loop_that_makes_all_turns_itself_is_woken(process: Process) -> None:
    thread = while_it_waits(process, process.wake)
    for _ in process.turns(never()):
        process.leave()
    thread.join()
