"""The watchdog: each turn puts off the end of the process, and no turn before the first one is waited for."""

import faulthandler
import os
import signal

import pytest

from giraff_node.process.lifecycle import Process, restart_program
from giraff_node.process.watchdog import Watchdog

PERIOD = {"WATCHDOG_USEC": "3000000"}


@pytest.fixture
def armed(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Collects the s for which a timer of the kernel is armed, which would end the test; 0: it is disarmed."""
    seconds: list[float] = []

    def setitimer(_which: int, given: float, again: float = 0.0) -> None:
        seconds.append(given)
        assert again == pytest.approx(0.1 * given)  # ends a process whose log nobody reads

    monkeypatch.setattr(signal, "setitimer", setitimer)
    monkeypatch.setattr(faulthandler, "register", lambda *_args, **_options: None)
    return seconds


def test_a_turning_loop_arms_it_anew_long_before_its_end(armed: list[float]) -> None:
    watchdog = Watchdog(PERIOD)
    watchdog.stopping()
    assert armed == []  # before the first turn it waits for nothing
    at = []
    for turn in range(50):  # 5 s
        before = len(armed)
        watchdog.turn(100.0 + turn * 0.1)
        at += [turn * 0.1] * (len(armed) - before)
    assert at == pytest.approx([0.1, 1.1, 2.1, 3.1, 4.1])  # the first turn itself may take its time
    watchdog.stopping()
    assert armed == [3.0] * 5 + [6.0]


def test_where_nobody_starts_it_again_it_may_hang(armed: list[float]) -> None:
    for environment in ({}, {"WATCHDOG_USEC": "0"}, {"WATCHDOG_USEC": "soon"}, PERIOD | {"WATCHDOG_PID": "1"}):
        watchdog = Watchdog(environment)
        watchdog.turn(0.0)
        watchdog.stopping()
    assert armed == []


def test_the_loop_of_a_service_is_watched(armed: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    handlers = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    monkeypatch.setenv("WATCHDOG_USEC", "3000000")
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    try:
        process = Process("guard")
        for _ in process.turns():
            process._next_look = 0.0
            if armed:
                process.leave()
            process.wake()
        process._waker.close()
    finally:
        signal.set_wakeup_fd(-1)
        for number, handler in handlers.items():
            signal.signal(number, handler)
    assert armed == [3.0, 6.0]  # in a turn, and for the end


def test_a_program_that_starts_again_is_not_ended_by_the_timer_of_the_last(
    armed: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The kernel would keep the timer."""

    def execve(*_words: object) -> None:
        assert armed == [0.0]
        raise InterruptedError

    monkeypatch.setattr(os, "execve", execve)
    with pytest.raises(InterruptedError):
        restart_program()
