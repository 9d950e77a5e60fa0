"""`giraff` as the tests fork it (tests/support/zygote.py): like a fresh one, and it outlives nobody who asked."""

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.support.elsewhere import GIRAFF, clean
from tests.support.waiting import wait
from tests.support.zygote import run_giraff

FOREVER = ("topic", "echo", "odom", "--robot", "sim-nobody", "--for", "600")
ASKING = f"""
import os
from pathlib import Path
from tests.support.zygote import run_giraff

run_giraff({FOREVER}, Path(), os.environ, 600.0)
"""


def environment() -> dict[str, str]:
    """A network of its own."""
    network = {"GIRAFF_NETWORK_LOCAL": "true", "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}"}
    return clean(dict(os.environ)) | network


@pytest.mark.parametrize(
    "words", [("why", "--help"), ("estop", "engage", "--robot", "sim-nobody", "--timeout", "0.2"), ("nonsense",)]
)
def test_it_says_and_ends_as_a_fresh_one_does(words: tuple[str, ...], tmp_path: Path) -> None:
    forked = run_giraff(words, tmp_path, environment(), 60.0)
    fresh = subprocess.run(forked.args, cwd=tmp_path, env=environment(), check=False, capture_output=True, text=True)
    assert forked.args == [str(GIRAFF), *words]
    assert (forked.returncode, forked.stdout, forked.stderr) == (fresh.returncode, fresh.stdout, fresh.stderr)


def test_it_ends_with_the_patience_of_who_asked(tmp_path: Path) -> None:
    with pytest.raises(subprocess.TimeoutExpired):
        run_giraff(FOREVER, tmp_path, environment(), 0.2)
    [zygote] = [each for each in psutil.Process().children() if "zygote.py" in " ".join(each.cmdline())]
    wait(lambda: not zygote.children(), 60.0, what="the end of the command")


def test_nothing_is_left_of_one_whose_asker_is_killed() -> None:
    with subprocess.Popen([sys.executable, "-c", ASKING], cwd=ROOT, env=environment()) as asker:
        wait(lambda: len(psutil.Process(asker.pid).children(recursive=True)) == 2, 60.0, what="zygote and command")
        below = psutil.Process(asker.pid).children(recursive=True)
        asker.kill()
    wait(lambda: not any(map(runs, below)), 60.0, what="the end of both")


def runs(process: psutil.Process) -> bool:
    try:
        return process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
