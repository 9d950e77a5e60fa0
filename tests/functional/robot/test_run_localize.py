"""`giraff run --localize` and `giraff localize` as processes: found, shown, told where the robot is, and summed up."""

import json
import shlex
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from giraff_telemetry.localization_summary import LocalizationSummary
from tests.support.process_robot import PATIENCE
from tests.support.runs import GIRAFF, PROCESSES, SMALL_ROOM, Command, command_in, line_of
from tests.support.waiting import wait


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    with command_in(tmp_path) as made:
        yield made


def test_a_run_looks_for_its_robot_on_its_own_map(command: Command, tmp_path: Path) -> None:
    def localize(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(GIRAFF), "localize", *target, *words],
            env=command.environment,
            cwd=command.directory,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def until_done(*words: str) -> subprocess.CompletedProcess[str]:
        """Tried again, for on a busy machine it may find nobody."""
        tried: list[subprocess.CompletedProcess[str]] = []

        def is_done() -> bool:
            tried.append(localize(*words))
            return tried[-1].returncode == 0

        wait(is_done, PATIENCE, what=lambda: tried[-1].stderr)
        return tried[-1]

    summary, room = tmp_path / "summary.json", tmp_path / "small.toml"
    room.write_text(SMALL_ROOM)
    words = ("--localize", "--world", str(room), "--hand", "none", "--boards", "host", "--summary", str(summary))
    with command.start(*words) as process:
        line = line_of(process, "giraff drive")
        target = shlex.split(line)[shlex.split(line).index("drive") + 1 :]
        line_of(process, " | map told x ")
        assert len(command.pids()) == PROCESSES + 2
        asked = until_done("--at", "0.1,0,0deg")
        assert asked.stderr == ""
        assert " is taken to be at about x 0.10 y 0.00 m, 0.0°, ± 0.42 m, 11°; " in asked.stdout
        shown = until_done("--for", "0.6", "--json")
        poses = [json.loads(line) for line in shown.stdout.splitlines()]
        assert {(pose["map"], pose["state"]) for pose in poses} == {("small", "told")}, "it has not moved"
        assert [round(value, 1) for value in (poses[-1]["x"], poses[-1]["y"])] == [0.1, 0.0]
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")
    assert command.leaves_nothing()
    assert "knew its place  it has not moved" in out
    told = msgspec.convert(json.loads(summary.read_text())["localization"], LocalizationSummary)
    assert (told.map, told.state, told.shares) == ("small", "told", None)
    assert told.error is not None
    assert 0.05 < told.error.end_m < 0.15
