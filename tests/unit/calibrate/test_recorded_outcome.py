"""`giraff calibrate odometry` of recorded runs: where its outcome goes, and what it does where nothing is new."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from giraff_cli.calibrate.judgement import Checked, Judgement
from giraff_cli.calibrate.recorded import tables
from giraff_core.kinematics.calibration import Scales
from tests.unit.calibrate.recorded import table_of
from tests.unit.calibrate.test_recorded import (
    CHECK,
    FIT,
    METADATA,
    OTHERS,
    Typed,
    made_up,
    refused,
    robot_file,
    save,
    say,
)

__all__ = ["robot_file", "say"]
TABLE = table_of("square-a_run-04")
OWN = ("--fit", "run-[0-3].csv", "--check", "run-[45].csv")


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("more", [(), ("--metadata", "metadata.csv")])
@pytest.mark.usefixtures("robot_file")
def test_the_outcome_overwrites_nothing_that_is_read(say: Typed, tmp_path: Path, more: tuple[str, ...]) -> None:
    made_up(tmp_path, Scales(1.01, 0.99, 1.03))
    (tmp_path / "link.toml").symlink_to("robot/robot.toml")
    (tmp_path / "metadata.csv").write_bytes(Path(METADATA).read_bytes())
    before = contents(tmp_path)
    for name in ("robot/robot.toml", "link.toml", "run-0.csv", "run-5.csv", *more[1:]):
        line = refused(say(*OWN, *more, "--json", name))
        assert f"--json {name} is " in line
        assert "give it a name of its own" in line
        assert contents(tmp_path) == before


def without_a_way_in(folder: Path) -> str:
    (folder / "locked").mkdir(mode=0o500)
    return "locked/found.json"


def loop(folder: Path) -> str:
    (folder / "loop").symlink_to("loop")
    return "loop"


def pipe(folder: Path) -> str:
    os.mkfifo(folder / "pipe")
    return "pipe"


NOWHERE: dict[str, tuple[Callable[[Path], str], str]] = {
    "no folder": (lambda _: "none/found.json", "none/found.json: there is no such folder"),
    "a file as folder": (lambda _: "run-0.csv/found.json", "run-0.csv/found.json: "),
    "a folder": (lambda _: "robot", "robot: is no file; name one"),
    "a loop": (loop, "loop: cannot be written: Symlink loop"),
    "a pipe": (pipe, "pipe: is no file; name one"),
    "locked": (without_a_way_in, "locked/found.json: its folder cannot be written"),
    "too long": (lambda _: "x" * 300, ": cannot be written: File name too long"),
}


@pytest.mark.parametrize("name", NOWHERE)
def test_an_outcome_that_has_no_place_is_refused_before_anything_is_written(
    say: Typed, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    make, expected = NOWHERE[name]
    made_up(tmp_path, Scales(1.01, 0.99, 1.03))
    target = make(tmp_path)
    monkeypatch.setattr(os, "access", lambda path, _mode: Path(path).stat().st_mode & 0o200)  # root may do all
    before = contents(tmp_path)
    assert expected in refused(say(*OWN, "--json", target))
    assert contents(tmp_path) == before
    assert robot_file.exists()


def test_a_disk_that_takes_the_robot_file_and_not_the_outcome_is_told_so(
    say: Typed, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made_up(tmp_path, Scales(1.01, 0.99, 1.03))
    whole = os.fsync
    done: list[int] = []

    def full(descriptor: int) -> None:
        done.append(descriptor)
        if len(done) > 4:  # a copy of the robot file, its folder; the robot file, its folder
            raise OSError(28, "No space left on device")
        whole(descriptor)

    monkeypatch.setattr(os, "fsync", full)
    line = refused(say(*OWN, "--json", "found.json"), 3)
    assert "found.json: cannot be written: No space left on device" in line
    assert f"{robot_file} is written, this is not" in line
    assert "[robot.calibration]" in robot_file.read_text(encoding="utf-8")
    assert not (tmp_path / "found.json").exists()


@pytest.mark.parametrize("session", ["", "square-a", "square-b"])
def test_the_same_runs_once_more_gain_nothing(say: Typed, robot_file: Path, tmp_path: Path, session: str) -> None:
    words: tuple[str, ...] = OWN
    if session:
        words = tuple(word.replace("square-a", session) for word in (*FIT, *CHECK))
    else:
        made_up(tmp_path, Scales(1.01, 0.99, 1.03))
    assert say(*words)[0] == 0
    before = contents(robot_file.parent)
    assert len(before) == 2
    code, out, complaint = say(*words, "--json", "found.json")
    print(out)
    assert (code, complaint) == (0, "")
    assert "Nothing to gain: it is calibrated so already" in out
    assert contents(robot_file.parent) == before
    found = json.loads((tmp_path / "found.json").read_text())
    assert (found["refused"], found["robot_file"]) == ("", None)
    if session != "square-b":  # there the fit itself comes out 1 mm different
        assert "Worse than before" not in out
        assert "as before" in out


def test_a_robot_that_is_as_it_was_built_is_calibrated_all_the_same(
    say: Typed, robot_file: Path, tmp_path: Path
) -> None:
    """Its factors stay; that they are known is new."""
    made_up(tmp_path, Scales(1.0, 1.0, 1.0))
    code, out, _ = say(*OWN)
    assert (code, "Nothing to gain" in out) == (0, False)
    assert "[robot.calibration]" in robot_file.read_text(encoding="utf-8")


def test_less_than_a_tenth_of_a_millimetre_is_not_worse() -> None:
    one, other = Checked("one", 0.0035, 0.00359, 0.0, 0.0), Checked("other", 0.0035, 0.0037, 0.0, 0.0)
    assert (Judgement((one,)).worse, Judgement((one,)).refusal) == ((), "")
    judgement = Judgement((one, other))
    assert judgement.worse == ("other",)
    assert "0.0036 m off on average, and 0.0035 m" in judgement.refusal


def test_a_run_at_rest_is_told_as_one(say: Typed, tmp_path: Path) -> None:
    """Its encoders flutter by a count."""
    table = TABLE[:24].copy()
    table[1::2, 4], table[2::2, 4] = 1, -1
    line = refused(say(*OTHERS, "--fit", save(tmp_path / "still.csv", table)))
    assert "still.csv: no wheel turned in it; leave it out" in line


def test_a_run_of_too_many_rows_says_how_to_thin_it(
    say: Typed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "MOST_ROWS", 100)
    save(tmp_path / "enough.csv", TABLE[:100])
    assert len(tables.read_table(tmp_path / "enough.csv")) == 100
    long = save(tmp_path / "long.csv", TABLE[:101])
    line = refused(say("--metadata", METADATA, "--fit", long, *CHECK))
    assert "long.csv: more than 100 rows" in line
    assert "with its counts and those of the rows left out summed up" in line
