"""The end of a process whose loop does not turn: it has the stacks in its log wherever they can be written."""

import os
import signal
import subprocess
import sys
import time

import pytest

_PERIOD = 0.3  # s
_ARMED = f"""
import os, signal, threading, time
from giraff_node.process.watchdog import Watchdog

watchdog = Watchdog({{"WATCHDOG_USEC": "{_PERIOD * 1e6:.0f}"}})
"""
_TURNS = "watchdog.turn(0.0); watchdog.turn(1.0)\n"
_STOPPED = f"""{_ARMED}{_TURNS}
os.kill(os.getpid(), signal.SIGSTOP)
threading.Event().wait()
"""
_UNREAD = f"""{_ARMED}
os.set_blocking(2, False)
for size in (4096, 1):
    try:
        while True:
            os.write(2, bytes(size))
    except BlockingIOError:
        pass
os.set_blocking(2, True)
{_TURNS}
threading.Event().wait()
"""


@pytest.mark.parametrize("program", [_STOPPED, _UNREAD], ids=["stopped for longer than that", "nobody reads its log"])
def test_it_ends_by_the_alarm_and_writes_its_stacks_where_it_can(program: str) -> None:
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            if program is _STOPPED:
                os.waitid(os.P_PID, process.pid, os.WSTOPPED)
                time.sleep(2 * _PERIOD)  # all of its timers are overdue when it goes on
                process.send_signal(signal.SIGCONT)
            assert process.wait(60.0) == -signal.SIGALRM
            assert process.stderr is not None
            assert program is _UNREAD or "(most recent call first)" in process.stderr.read()
        finally:
            process.kill()
