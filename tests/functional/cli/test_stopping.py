"""Being told to end wakes whoever waits, at once."""

import os
import signal
import threading
from collections.abc import Iterator

import pytest

from giraff_tools.terminal.signals import StopSignal


def signal_soon(number: signal.Signals, seconds: float = 0.1) -> None:
    threading.Timer(seconds, os.kill, [os.getpid(), number]).start()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_wait(number: signal.Signals) -> None:
    with StopSignal() as stopping:
        assert not stopping.wait(0.01)
        signal_soon(number)
        assert stopping.wait(1e11), "which is more than the system waits at once"
        assert stopping.wait(600.0), "and every wait after it"


def test_a_wait_may_outlast_the_first_signal() -> None:
    with StopSignal() as stopping:
        stopping.ask()
        assert not stopping.wait(0.05, patience=2)
        signal_soon(signal.SIGINT)
        assert stopping.wait(600.0, patience=2)


@pytest.fixture
def _python_hears_sigint() -> Iterator[None]:
    """In the background of a shell without job control a process begins with SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("_python_hears_sigint")
def test_signals_are_as_before_afterwards() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    with StopSignal():
        assert signal.getsignal(signal.SIGTERM) != before[1]
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
