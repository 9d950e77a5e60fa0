"""No process of a run outlives it, however either ends. The processes are stand-ins of a line or two."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_cli.run.processes import ProcessGroup
from tests.support.waiting import wait

STUBBORN = """
import signal, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
signal.signal(signal.SIGINT, signal.SIG_IGN)
print("up", flush=True)
time.sleep(600.0)
"""
OBEDIENT = """
import signal, sys, time
signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
print("up", flush=True)
time.sleep(600.0)
"""
CLUMSY = """
import signal, sys, time
signal.signal(signal.SIGTERM, lambda *_: sys.exit(3))
print("up", flush=True)
time.sleep(600.0)
"""
DYING = """
import sys
print("\\n".join(f"line {number}" for number in range(10)), file=sys.stderr)
sys.exit("the port is gone")
"""
PARENT = Path(__file__).with_name("children_of.py")


@pytest.fixture
def children(tmp_path: Path) -> Iterator[ProcessGroup]:
    for name, source in {"stubborn": STUBBORN, "obedient": OBEDIENT, "clumsy": CLUMSY, "dying": DYING}.items():
        (tmp_path / f"{name}.py").write_text(source)
    started = ProcessGroup(tmp_path)
    yield started
    started.stop_all(grace=0.0)


def start(children: ProcessGroup, directory: Path, name: str) -> None:
    children.start(name, name, [], os.environ | {"PYTHONPATH": str(directory)})


def is_up(children: ProcessGroup, name: str) -> bool:
    return children.output(name).read_bytes() == b"up\n"


def is_running(pid: int) -> bool:
    """Also a zombie has ended: whoever should reap it is init."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8")
    except (FileNotFoundError, ProcessLookupError):
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"


def test_one_that_ignores_sigterm_is_killed(children: ProcessGroup, tmp_path: Path) -> None:
    start(children, tmp_path, "stubborn")
    start(children, tmp_path, "obedient")
    pids = [children.pid("stubborn"), children.pid("obedient")]
    wait(lambda: is_up(children, "stubborn") and is_up(children, "obedient"), 60.0, what="both are up")
    troubles = children.stop_all(grace=0.3)
    assert troubles == ["stubborn did not end within 0.3 s and was killed"]
    assert not any(map(is_running, pids))
    assert not any(Path(f"/proc/{pid}").exists() for pid in pids), "not reaped"


def test_one_that_ends_with_an_error_when_told_to_is_named(children: ProcessGroup, tmp_path: Path) -> None:
    start(children, tmp_path, "clumsy")
    wait(lambda: is_up(children, "clumsy"), 60.0, what="it is up")
    assert children.stop(["clumsy"], grace=60.0) == ["clumsy ended with exit code 3 when it was told to end"]


def test_only_the_named_ones_are_stopped(children: ProcessGroup, tmp_path: Path) -> None:
    start(children, tmp_path, "stubborn")
    start(children, tmp_path, "obedient")
    wait(lambda: is_up(children, "stubborn") and is_up(children, "obedient"), 60.0, what="both are up")
    assert children.stop(["obedient", "absent"], grace=60.0) == []
    assert is_running(children.pid("stubborn"))


def test_one_that_ends_by_itself_is_named_once_with_its_last_words(children: ProcessGroup, tmp_path: Path) -> None:
    start(children, tmp_path, "dying")
    start(children, tmp_path, "obedient")
    wait(lambda: bool(children.reap()), 60.0, what="it has ended")
    ended = children.ended["dying"]
    assert ended.how == "exit code 1"
    log = children.log("dying")
    assert str(ended) == f"dying ended by itself (exit code 1): the port is gone; its log: {log}"
    assert children.last_words("dying") == ("line 6", "line 7", "line 8", "line 9", "the port is gone")
    assert children.reap() == []
    assert is_running(children.pid("obedient"))


def test_a_signal_that_ended_one_is_named(children: ProcessGroup, tmp_path: Path) -> None:
    start(children, tmp_path, "obedient")
    wait(lambda: is_up(children, "obedient"), 60.0, what="it is up")
    os.kill(children.pid("obedient"), signal.SIGKILL)
    wait(lambda: bool(children.reap()), 60.0, what="it has ended")
    assert str(children.ended["obedient"]).startswith("obedient ended by itself (killed, SIGKILL): it was ended from")


def test_they_are_in_sessions_of_their_own(children: ProcessGroup, tmp_path: Path) -> None:
    """Ctrl-C reaches the parent alone, who ends them in the right order."""
    start(children, tmp_path, "obedient")
    pid = children.pid("obedient")
    assert os.getsid(pid) == pid != os.getsid(0)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV])
def test_nothing_outlives_its_parent(children: ProcessGroup, tmp_path: Path, number: signal.Signals) -> None:
    command = [sys.executable, str(PARENT), str(tmp_path), "stubborn", "obedient"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        pids = [int(word) for word in parent.stdout.readline().split()]
        wait(lambda: is_up(children, "stubborn") and is_up(children, "obedient"), 60.0, what="both are up")
        parent.send_signal(number)
        parent.wait(60.0)
    assert len(pids) == 2
    wait(lambda: not any(map(is_running, pids)), 60.0, what="the end of both")


def test_one_whose_parent_has_ended_before_it_began_does_not_begin(tmp_path: Path) -> None:
    launch = Path(sys.modules[ProcessGroup.__module__].__file__ or "").with_name("launch.py")
    not_the_parent = str(os.getppid())
    command = [sys.executable, "-I", "-S", str(launch), not_the_parent, sys.executable, "-c", "print('began')"]
    run = subprocess.run(command, check=False, capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 1
    assert run.stdout == ""
    assert "the parent has ended" in run.stderr
