"""Docker's check: at once where something may be wrong, and else it stays, as long as all loops turn."""

import os
import subprocess
from pathlib import Path

from giraff_sim.board import ROOT

PROGRAM = ROOT / "services" / "giraff_health" / "wait.sh"


def check(folder: Path, *services: str, news: str = "") -> tuple[int, str, int]:
    """Exit code, words, and how often it slept. No time passes: in each sleep base's loop turns, and `news` happen."""
    tools, slept = folder / "bin", folder / "slept"
    tools.mkdir(exist_ok=True)
    slept.write_text("")
    (tools / "sleep").write_text(f"#!/bin/sh\ncd {folder}; echo >>slept; touch base.faults; {news}\n")
    (tools / "sleep").chmod(0o755)
    environment = os.environ | {"RUNTIME_DIRECTORY": str(folder), "PATH": f"{tools}:{os.environ['PATH']}"}
    done = subprocess.run(
        ["sh", str(PROGRAM), *services], env=environment, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.stderr == ""
    return done.returncode, done.stdout, len(slept.read_text())


def test_what_is_wrong_at_the_start_is_told_after_one_look(tmp_path: Path) -> None:
    (tmp_path / "ranger.faults").write_text("/dev/x: unplugged\nthe disk is full\n")
    (tmp_path / "guard.faults").touch()
    os.utime(tmp_path / "guard.faults", (1.0, 1.0))
    code, words, slept = check(tmp_path, "base", "ranger", "guard", "door", "base")
    assert (code, slept) == (1, 1)
    assert words.splitlines() == [
        "/dev/x: unplugged",
        "the disk is full",
        "guard: its loop has not turned for 2 s: it hangs, or this machine is overloaded",
        "door has not said how it is; see its log",
    ]
    assert not (tmp_path / "asked").exists()  # so that the next check tells at once, too


def test_a_well_service_is_seen_at_once_and_then_watched_for_a_minute_or_until_there_is_news(tmp_path: Path) -> None:
    assert check(tmp_path, "base") == (0, "", 1)
    code, words, slept = check(tmp_path, "base")
    assert (code, words) == (0, "")
    assert 28 <= slept <= 35  # s, the half of it: Docker's `timeout` is for a check that is lost
    news = '[ $(wc -l <slept) -lt 3 ] || echo "/dev/x: unplugged" >base.faults'
    assert check(tmp_path, "base", news=news) == (1, "/dev/x: unplugged\n", 3)
