"""`make run` where packages are missing: one line to paste names them all."""

import shutil
import subprocess
from pathlib import Path

import pytest

from giraff_sim.board import ROOT

_TOOLS = ("bash", "dirname", "env", "id", "python3", "readlink")
_RUN = ["python3-venv", "gcc", "libc6-dev", "gcc-avr", "avr-libc", "libsimavr-dev"]


@pytest.mark.parametrize(("apt", "lines"), [(True, 1), (False, 0)], ids=["Debian", "elsewhere"])
def test_what_is_missing_stands_at_the_end_and_whole(apt: bool, lines: int, tmp_path: Path) -> None:
    tools, tree = tmp_path / "tools", tmp_path / "tree"
    (tree / "scripts").mkdir(parents=True)
    tools.mkdir()
    script = shutil.copy(ROOT / "scripts" / "setup", tree / "scripts")
    for name in _TOOLS:
        (tools / name).symlink_to(shutil.which(name) or "/nowhere")
    if apt:
        (tools / "apt-get").write_text("#!/bin/sh\nexit 100\n")
        (tools / "apt-get").chmod(0o755)
    done = subprocess.run(
        [shutil.which("bash") or "bash", script, "run"],
        env={"PATH": str(tools)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "no C compiler with its headers: install the packages gcc and libc6-dev" in done.stderr
    advice = [line for line in done.stderr.splitlines() if "sudo apt-get install" in line]
    assert len(advice) == lines
    if apt:
        assert done.stderr.splitlines()[-1] == advice[0]
        *_, named = advice[0].partition("apt-get install ")
        assert named.split() == [each for each in _RUN if each != "python3-venv" or each in named]
    assert {path.name for path in tree.iterdir()} == {"scripts"}


def test_what_a_link_leads_to_is_neither_emptied_nor_filled(tmp_path: Path) -> None:
    """A virtual environment that is made anew empties whatever folder a link leads to."""
    tree, other = tmp_path / "tree", tmp_path / "other"
    (tree / "scripts").mkdir(parents=True)
    other.mkdir()
    (other / "kept").touch()
    (tree / ".venv").symlink_to(other)
    script = shutil.copy(ROOT / "scripts" / "setup", tree / "scripts")
    done = subprocess.run([script, "run"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert f".venv is a link to {other}, which set-up would empty or overwrite; type: rm .venv\n" in done.stderr
    assert [*other.iterdir()] == [other / "kept"]
