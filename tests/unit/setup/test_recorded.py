"""`giraff calibrate odometry` of recorded runs: what it finds, writes and refuses."""

import json
import math
import os
import re
import shutil
import tomllib
from collections.abc import Callable
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest

from giraff_core.kinematics.calibration import Scales
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import load
from giraff_setup.wheels.odometry.recorded.slips import require_plausible
from giraff_setup.wheels.odometry.recorded.tables import RecordingError
from giraff_setup.wheels.odometry.runs import Floats, Geometry, Run
from tests.rules.repository import ROOT
from tests.unit.cli.typed import Giraff, typed
from tests.unit.setup.recorded import DATA, GEOMETRY, driven, square, straight, table_of, turn

METADATA = str(DATA / "square-a_metadata.csv")
FIT = tuple(f"--fit={DATA / f'square-a_run-0{number}.csv'}" for number in (1, 2, 4, 5))
CHECK = tuple(f"--check={DATA / f'square-a_run-0{number}.csv'}" for number in (3, 6))
OTHERS = ("--metadata", METADATA, *FIT, *CHECK)
"""A good command about another robot."""


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Giraff:
    """Types `giraff calibrate odometry` in a folder of its own: exit code, output, complaint."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GIRAFF_CONFIG", raising=False)
    return lambda *words: typed(monkeypatch, capsys, "calibrate", "odometry", *map(str, words))


@pytest.fixture
def robot_file(monkeypatch: pytest.MonkeyPatch, say: Giraff, tmp_path: Path) -> Path:
    """Of a robot like the one that `driven` makes up, in a folder of its own."""
    del say  # it has set the folder
    path = tmp_path / "robot" / "robot.toml"
    path.parent.mkdir()
    text = (ROOT / "deploy" / "robot.toml").read_text()
    text = text.replace("track_width = 0.470 ", f"track_width = {GEOMETRY.track_width} ")
    path.write_text(text.replace("ticks_per_metre = 2002.0594 ", f"ticks_per_metre = {GEOMETRY.ticks_per_metre} "))
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    return path


def refused(done: tuple[int, str, str], code: int = 2) -> str:
    """The one line that a refusal is told in."""
    assert done[0] == code, done
    [line] = done[2].splitlines()
    assert line.startswith("giraff calibrate odometry: ")
    return line


def save(path: Path, table: Floats) -> Path:
    """As a file of a recorded run."""
    path.write_text(
        "".join(f"{t!r},{x!r},{y!r},{yaw!r},{right:.0f},{left:.0f}\n" for t, x, y, yaw, right, left in table.tolist()),
        encoding="utf-8",
    )
    return path


def tabled(run: Run) -> Floats:
    """As the rows of a file, 20 a second."""
    rows = np.array([(pose.row / 20.0, pose.x, pose.y, pose.yaw) for pose in run.measured])
    return np.vstack((np.zeros((1, 6)), np.column_stack((rows, run.right, run.left))))


def made_up(folder: Path, scales: Scales, *, seed: int = 0, runs: int = 6) -> None:
    """Runs of a robot with these scales, as files."""
    random = np.random.default_rng(seed)
    for number in range(runs):
        run = driven(str(number), square(1.0, (1, -1)[number % 2]), scales, random, slip=1e-6)
        save(folder / f"run-{number}.csv", tabled(run))


def test_it_tells_people_and_programs_what_it_found_in_runs_named_by_patterns_commas_and_again(say: Giraff) -> None:
    code, out, told = wanted = say(*OTHERS, "--json")
    assert code == 0
    assert "square-a_run-03.csv" in told
    assert "Nothing was written" in told
    found = json.loads(out)
    assert found["end_error_after"] < 0.5 * found["end_error_before"]
    assert [run["worse"] for run in found["checked"]] == [False, False]
    assert found["refused"] == ""
    assert found["robot_file"] is None
    assert all(0.0 < sd < 0.01 for sd in found["scales"]["sd"].values())
    both = ",".join(f"{DATA}/square-a_run-0{number}.csv" for number in (3, 6))
    pattern = f"{DATA}/square-a_run-0[1245].csv"
    assert say("--metadata", METADATA, "--fit", pattern, "--check", both, "--json") == wanted


def test_a_robots_own_runs_are_written_into_its_file(say: Giraff, robot_file: Path, tmp_path: Path) -> None:
    true = Scales(1.01, 0.99, 1.03)
    made_up(tmp_path, true)
    before = robot_file.read_text(encoding="utf-8")
    code, out, told = say("--fit", "run-[0-3].csv", "--check", "run-[45].csv", "--json")
    assert code == 0, told
    calibration = load("robot", RobotConfig).calibration
    print(out, calibration)
    sds = [calibration.covariance[place] ** 0.5 for place in (0, 3, 5)]
    assert all(abs(one - other) < 4.0 * sd for one, other, sd in zip(calibration.scales, true, sds, strict=True))
    assert calibration.end_error_after < 0.1 * calibration.end_error_before
    [kept] = robot_file.parent.glob("robot.toml.before-*")
    assert kept.name == f"robot.toml.before-{calibration.date}"
    assert kept.read_text() == before
    was, now = tomllib.loads(before), tomllib.loads(robot_file.read_text(encoding="utf-8"))
    del now["robot"]["calibration"]
    assert now == was
    assert json.loads(out)["robot_file"] == str(robot_file)


@pytest.mark.parametrize(
    ("scales", "told"),
    [
        (Scales(1.06, 1.06, 1.06), "left wheel would change by +6.0 %, more than 5 %"),
        (Scales(1.0, 1.0, 1.12), "track would change by +1"),
    ],
)
def test_a_wheel_or_a_track_far_from_before_takes_force(
    say: Giraff, robot_file: Path, tmp_path: Path, scales: Scales, told: str
) -> None:
    made_up(tmp_path, scales)
    words = ("--fit", "run-[0-3].csv", "--check", "run-[45].csv")
    before = robot_file.read_text(encoding="utf-8")
    line = refused(say(*words), 1)
    assert told in line
    assert "give --force" in line
    assert robot_file.read_text(encoding="utf-8") == before
    assert say(*words, "--force")[0] == 0
    found = load("robot", RobotConfig).calibration
    assert found.left_wheel_scale == pytest.approx(scales.left_wheel, abs=0.002)


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_what_makes_the_checked_runs_worse_is_refused(
    say: Giraff, robot_file: Path, tmp_path: Path, force: tuple[str, ...]
) -> None:
    """Fitted to one robot, checked on another."""
    made_up(tmp_path, Scales(1.02, 0.98, 1.05), runs=4)
    (tmp_path / "other").mkdir()
    made_up(tmp_path / "other", Scales(0.99, 1.01, 0.97), seed=1, runs=2)
    before = robot_file.read_text(encoding="utf-8")
    code, out, told = say("--fit", "run-*.csv", "--check", "other/run-*.csv", "--json", *force)
    assert (code, told.splitlines()[-1].startswith("giraff calibrate odometry: refused: ")) == (1, True)
    assert "Worse than before: other/run-0.csv." in told
    assert robot_file.read_text(encoding="utf-8") == before
    assert os.listdir(robot_file.parent) == ["robot.toml"]  # noqa: PTH208
    assert "those stay" in json.loads(out)["refused"]


def test_one_run_that_gets_worse_is_named_though_the_mean_is_better(say: Giraff, tmp_path: Path) -> None:
    made_up(tmp_path, Scales(1.02, 0.98, 1.05))
    (tmp_path / "other").mkdir()
    made_up(tmp_path / "other", Scales(0.995, 1.005, 0.99), seed=1, runs=1)
    done = say("--metadata", METADATA, "--fit", "run-[0-3].csv", "--check", "run-[45].csv,other/run-0.csv")
    assert done[0] == 0
    assert "Worse than before: other/run-0.csv." in done[1]


def test_what_does_not_tell_the_scales_is_refused(say: Giraff, tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    files = []
    for number in range(2):
        run = driven(str(number), straight(3.0), Scales(1.0, 1.0, 1.0), random)
        files.append(save(tmp_path / f"line-{number}.csv", tabled(run)))
    line = refused(say("--metadata", METADATA, "--fit", f"{files[0]},{files[1]}", *CHECK), 1)
    assert "how far the robot turns is not determined: add turns" in line


HEAD = "0,0,0,0,0,0\n0.1,0.001,0,0,11,11\n"
BAD: dict[str, tuple[str | bytes, str]] = {
    "five columns": (HEAD + "0.2,0,0,0,1\n", "row 3: 5 columns, not 6; a row is time s, x m, y m, heading rad, right"),
    "semicolons": (HEAD.replace(",", ";"), "row 1: 1 columns, not 6; are there semicolons"),
    "header": ("time,x,y,yaw,right,left\n" + HEAD, "row 1: time is 'time', no number; is there a header? remove it"),
    "text": (HEAD + "0.2,0,lost,0,1,1\n", "row 3: y is 'lost', no number; correct it"),
    "NaN": (HEAD + "0.2,nan,0,0,1,1\n", "row 3: x is nan: the truth was lost there"),
    "inf": (HEAD + "0.2,0,0,-inf,1,1\n", "row 3: heading is -inf"),
    "huge": (HEAD + "0.2,1e300,0,0,1,1\n", "row 3: x is 1e+300, which cannot be"),
    "wrapped": (HEAD + "0.2,0,0,0,1,-4294967290\n", "row 3: left counts is -4.29497e+09, more than a wheel can make"),
    "no time": (HEAD + "1e300,0,0,0,1,1\n", "row 3: time is 1e+300, which cannot be"),
    "16 bits": (
        HEAD + "0.2,0,0,0,11,-65525\n",
        "row 3: left counts is -65525; a counter of 16 bits wrapped there: add 65536",
    ),
    "half a count": (HEAD + "0.2,0,0,1,0.5,1\n", "row 3: right counts is 0.5, and counts are whole; are the columns"),
    "time back": (HEAD + "0.05,0,0,0,1,1\n", "row 3: time goes back from 0.1 to 0.05; are two runs in it?"),
    "empty": ("", "is empty; was the disk full"),
    "blank": ("\n\n", "is empty"),
    "one row": ("0,0,0,0,0,0\n", "one row is no run"),
    "still": ("0,0,0,0,0,0\n1,0,0,0,0,0\n", "no wheel turned in it; leave it out, or check the encoders"),
    "binary": (b"\xff\xfe\x00\x01", "is no CSV"),
    "zeros": (b"\x00" * 40, "row 1: "),
}


def test_a_file_that_is_no_run_is_told_with_its_row(say: Giraff, tmp_path: Path, robot_file: Path) -> None:
    path, good = tmp_path / "bad.csv", tmp_path / "good.csv"
    good.write_text("0,0,0,0,0,0\n0.1,0.05,0,0,530,530\n")
    before = robot_file.read_text(encoding="utf-8")
    for (name, (text, expected)), (one, other) in product(BAD.items(), permutations(("--fit", "--check"))):
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        line = refused(say(one, path, other, good))
        assert f"{path}" in line, name
        assert expected in line, name
        assert robot_file.read_text(encoding="utf-8") == before


def test_a_file_that_is_not_there_is_told(say: Giraff, tmp_path: Path) -> None:
    assert "no-such.csv: there is no such file" in refused(say(*OTHERS, "--fit", "no-such.csv"))
    assert "is a folder; name the files in it" in refused(say(*OTHERS, "--fit", tmp_path))
    assert "--fit no-*.csv: no file is called like that" in refused(say(*OTHERS, "--fit", "no-*.csv"))
    assert "--check names no file" in refused(say("--metadata", METADATA, *FIT))
    assert "--fit names no file" in refused(say("--metadata", METADATA, *CHECK))
    assert "--fit names no file" in refused(say("--metadata", METADATA, "--fit", ",", *CHECK))
    assert "no robot file at " in refused(say(*FIT, *CHECK))
    assert "belongs to no option; put a pattern in quotes" in refused(say(*OTHERS, "more.csv"))
    assert "are for a live robot" in refused(say(*OTHERS, "--robot", "otto"))


def test_a_run_is_fitted_or_checked_and_once(say: Giraff, tmp_path: Path) -> None:
    one = DATA / "square-a_run-01.csv"
    shutil.copy(one, tmp_path / "copy.csv")
    assert "is there twice; a run is fitted or checked, and once" in refused(say(*OTHERS, "--check", one))
    assert f"copy.csv: is the same run as {one}" in refused(say(*OTHERS, "--check", "copy.csv"))


def exchanged(table: Floats, one: int, other: int) -> Floats:
    order = list(range(6))
    order[one], order[other] = other, one
    return table[:, order]


def wrapping(table: Floats) -> Floats:
    """Counts since the row before, of a counter of 16 bits."""
    counter = np.remainder(np.cumsum(table[:, 4:], axis=0) + 32_768, 65_536) - 32_768
    return np.column_stack((table[:, :4], np.diff(counter, axis=0, prepend=0.0)))


def beside(table: Floats, ahead: float, aside: float) -> Floats:
    """Poses of a marker that is not on the middle between the wheels."""
    cos, sin = np.cos(table[:, 3]), np.sin(table[:, 3])
    moved = np.column_stack((ahead * cos - aside * sin, ahead * sin + aside * cos))
    return np.column_stack((table[:, 0], table[:, 1:3] + moved, table[:, 3:]))


SLIPS: dict[str, tuple[Callable[[Floats], Floats], str]] = {
    "left and right": (lambda table: exchanged(table, 4, 5), "columns of counts are exchanged"),
    "x and y": (lambda table: exchanged(table, 1, 2), "x and y are exchanged"),
    "y and heading": (lambda table: exchanged(table, 2, 3), "y and heading are exchanged"),
    "x and heading": (lambda table: exchanged(table, 1, 3), "x and heading are exchanged"),
    "degrees": (lambda table: table * (1, 1, 1, math.degrees(1.0), 1, 1), "heading is in degrees"),
    "clockwise": (lambda table: table * (1, 1, 1, -1, 1, 1), "heading is counted clockwise"),
    "millimetres": (lambda table: table * (1, 1000, 1000, 1, 1, 1), "x and y are in millimetres"),
    "backwards": (lambda table: table * (1, 1, 1, 1, -1, -1), "counts are negative forward"),
    "sums": (lambda table: np.column_stack((table[:, :4], np.cumsum(table[:, 4:], axis=0))), "counts are summed up"),
    "sums of 16 bits": (
        lambda table: np.column_stack((table[:, :4], np.cumsum(wrapping(table)[:, 4:], axis=0))),
        "counts are summed up",
    ),
    "marker": (
        lambda table: beside(table, 0.1, -0.15),
        " m to the left of the middle between the wheels; write x - a cos",
    ),
    "rows left out": (
        lambda table: np.delete(table, np.s_[700:760], axis=0),
        "rows are missing before row 701: a wheel",
    ),
    "every third": (lambda table: np.delete(table, np.s_[3::3], axis=0), "rows are missing before row "),
    "twice the counts": (lambda table: table * (1, 1, 1, 1, 2, 2), "are gear, counts of a turn and wheel diameter"),
    "time first again": (lambda table: table[:, (0, 0, 1, 2, 4, 5)], "x and y the second and third column"),
}


@pytest.mark.parametrize("name", SLIPS)
def test_columns_that_cannot_be_so_are_named(say: Giraff, tmp_path: Path, name: str) -> None:
    """In the file of one run, and in the table of another as it was read."""
    change, expected = SLIPS[name]
    path = save(tmp_path / "bad.csv", change(table_of("square-a_run-02")))
    line = refused(say("--metadata", METADATA, "--fit", path, CHECK[0]))
    assert line.startswith(f"giraff calibrate odometry: {path}: ")
    assert expected in line
    with pytest.raises(RecordingError, match=re.escape(expected)):
        require_plausible("bad", change(table_of("square-b_run-05")), GEOMETRY)


@pytest.mark.parametrize("geometry", [GEOMETRY, GEOMETRY._replace(track_width=0.47)])
def test_a_marker_is_named_on_whole_turns_too(geometry: Geometry) -> None:
    """A spin moves it and not the robot. In millimetres it would hardly move, but that is not the cause."""
    wider = geometry.track_width / GEOMETRY.track_width
    for radians in (6.0 * math.pi, -6.0 * math.pi):
        course = [(wider * left, wider * right) for left, right in turn(radians)]
        run = driven("spin", course, Scales(1.0, 1.0, 1.0), np.random.default_rng(0), slip=1e-6, geometry=geometry)
        table = tabled(run)
        require_plausible("spin", table, geometry)
        for offset in ((0.05, 0.0), (0.15, 0.0), (0.0, 0.1)):
            with pytest.raises(RecordingError, match="x and y are those of a marker"):
                require_plausible("spin", beside(table, *offset), geometry)


def test_times_may_have_gaps_where_counts_are_summed_up_and_any_unit(say: Giraff, tmp_path: Path) -> None:
    table = table_of("square-a_run-01").copy()
    table[500, 4:] += table[400:500, 4:].sum(axis=0)
    table = np.delete(table, np.s_[400:500], axis=0)
    table[:, 0] = 1.76e18 + 1e9 * table[:, 0]  # nanoseconds since 1970
    path = save(tmp_path / "summed.csv", table)
    assert say("--metadata", METADATA, f"--fit={path}", *FIT[1:], *CHECK)[::2] == (0, "")


METADATA_ROWS = {"type": "diff", "ngear": "43.7", "encRes": "64", "Li": "0.2", "Di": "0.084,0.084"}
BAD_METADATA: dict[str, tuple[dict[str, str | None], str]] = {
    "no gear": ({"ngear": None}, "ngear is missing (the gear's ratio); add a row like ngear,"),
    "no track": ({"Li": None}, "Li is missing (track width, m)"),
    "empty": ({"Li": ""}, "Li has 0 values, not 1"),
    "one wheel": ({"Di": "0.084"}, "Di has 1 values, not 2"),
    "unequal": ({"Di": "0.084,0.085"}, "Di has 0.084 and 0.085; give both wheels their mean"),
    "zero": ({"encRes": "0"}, "encRes is 0: it must be within"),
    "negative": ({"Li": "-0.2"}, "Li is -0.2: it must be within 0.05..2 m"),
    "millimetres": ({"Li": "200"}, "are these millimetres?"),
    "NaN": ({"Li": "nan"}, "Li is 'nan', no number; correct it (track width, m)"),
    "text": ({"ngear": "1:43"}, "ngear is '1:43', no number; correct it (the gear's ratio)"),
    "huge": ({"ngear": "1e300"}, "ngear is 1e+300: it must be within"),
    "omnidirectional": ({"type": "omni3"}, "type is omni3; only robots on two driven wheels"),
}


@pytest.mark.parametrize("name", BAD_METADATA)
def test_metadata_that_no_robot_can_have_are_told(say: Giraff, tmp_path: Path, name: str) -> None:
    changes, expected = BAD_METADATA[name]
    rows = {**METADATA_ROWS, **changes}
    path = tmp_path / "metadata.csv"
    path.write_text("".join(f"{key},{value}\n" for key, value in rows.items() if value is not None))
    line = refused(say("--metadata", path, FIT[0], CHECK[0]))
    assert f"{path}: {expected}" in line or (str(path) in line and expected in line)


def test_metadata_that_are_not_there_are_told(say: Giraff, tmp_path: Path) -> None:
    assert "there is no such file" in refused(say("--metadata", "none.csv", *FIT, *CHECK))
    assert "is a folder; --metadata takes one file" in refused(say("--metadata", tmp_path, *FIT, *CHECK))
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    assert "one of ngear, encRes, Li and Di" in refused(say("--metadata", "binary", *FIT, *CHECK))
    (tmp_path / "run.csv").write_text(HEAD)
    assert "run.csv: ngear is missing" in refused(say("--metadata", "run.csv", *FIT, *CHECK))


def test_a_full_disk_leaves_the_robot_file_as_it_was(
    say: Giraff, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made_up(tmp_path, Scales(1.01, 0.99, 1.03))
    before = robot_file.read_text(encoding="utf-8")

    def full(_descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    code, _, complaint = say("--fit", "run-[0-3].csv", "--check", "run-[45].csv")
    assert code == 1
    assert "No space left on device; write into [robot.calibration] by hand:" in complaint.splitlines()[0]
    assert robot_file.read_text(encoding="utf-8") == before
    assert os.listdir(robot_file.parent) == ["robot.toml"]  # noqa: PTH208
