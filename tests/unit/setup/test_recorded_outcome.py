"""`giraff calibrate odometry` of recorded runs: what it does where nothing is new."""

import json
from pathlib import Path

import pytest

from giraff_core.kinematics.calibration import Scales
from giraff_setup.wheels.odometry.judgement import Checked, Judgement
from giraff_setup.wheels.odometry.recorded import tables
from tests.unit.cli.typed import Giraff
from tests.unit.setup.recorded import table_of
from tests.unit.setup.test_recorded import CHECK, FIT, METADATA, OTHERS, made_up, refused, robot_file, save, say

__all__ = ["robot_file", "say"]
TABLE = table_of("square-a_run-04")
OWN = ("--fit", "run-[0-3].csv", "--check", "run-[45].csv")


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("session", ["", "square-a", "square-b"])
def test_the_same_runs_once_more_gain_nothing(say: Giraff, robot_file: Path, tmp_path: Path, session: str) -> None:
    words: tuple[str, ...] = OWN
    if session:
        words = tuple(word.replace("square-a", session) for word in (*FIT, *CHECK))
    else:
        made_up(tmp_path, Scales(1.01, 0.99, 1.03))
    assert say(*words)[0] == 0
    before = contents(robot_file.parent)
    assert len(before) == 2
    code, out, told = say(*words, "--json")
    assert code == 0
    assert "Nothing to gain: it is calibrated so already" in told
    assert contents(robot_file.parent) == before
    found = json.loads(out)
    assert (found["refused"], found["robot_file"]) == ("", None)
    if session != "square-b":  # there the fit itself comes out 1 mm different
        assert "Worse than before" not in told
        assert "as before" in told


def test_a_robot_that_is_as_it_was_built_is_calibrated_all_the_same(
    say: Giraff, robot_file: Path, tmp_path: Path
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


def test_a_run_at_rest_is_told_as_one(say: Giraff, tmp_path: Path) -> None:
    """Its encoders flutter by a count."""
    table = TABLE[:24].copy()
    table[1::2, 4], table[2::2, 4] = 1, -1
    line = refused(say(*OTHERS, "--fit", save(tmp_path / "still.csv", table)))
    assert "still.csv: no wheel turned in it; leave it out" in line


def test_a_run_of_too_many_rows_says_how_to_thin_it(
    say: Giraff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "MOST_ROWS", 100)
    save(tmp_path / "enough.csv", TABLE[:100])
    assert len(tables.read_table(tmp_path / "enough.csv")) == 100
    long = save(tmp_path / "long.csv", TABLE[:101])
    line = refused(say("--metadata", METADATA, "--fit", long, *CHECK))
    assert "long.csv: more than 100 rows" in line
    assert "with its counts and those of the rows left out summed up" in line
