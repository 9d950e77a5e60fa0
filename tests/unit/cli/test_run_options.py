"""`giraff run` with options that make no run: told in one line, and nothing is started."""

from __future__ import annotations

from pathlib import Path

import pytest

from giraff_cli.run import begin as run
from giraff_cli.run.plan import Plan
from giraff_sim.board import ROOT
from tests.unit.cli.typed import Giraff

BAD_SCRIPT = "bad.csv"
BAD_FILE = "bad.toml"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--for", "-3"], "--for -3: give a positive number of seconds"),
        (["--for", "nan"], "--for nan"),
        (["--for", "soon"], "giraff run: invalid value for '--for'"),
        (["--world", "nowhere.toml"], "nowhere.toml: cannot be read"),
        (["--tilt-script", BAD_SCRIPT], f"{BAD_SCRIPT}:2: x is 'up', not a number"),
        (["--summary", "missing/summary.json"], "cannot be written"),
        (["--boards", "wooden"], "'wooden'"),
        (["--hand", "mine"], "'mine'"),
        (["--file", "nowhere.toml"], "giraff run: invalid value for '--file': File 'nowhere.toml' does not exist"),
        (["--file", BAD_SCRIPT], f"{BAD_SCRIPT}: not TOML"),
        (["--file", BAD_FILE], f"{BAD_FILE}: table [ranger]: unknown field `prot`"),
        (["--fast"], "giraff run: no option --fast"),
    ],
)
def test_bad_input_is_refused_before_anything_is_started(
    options: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    def drive(plan: Plan) -> int:
        raise AssertionError(f"it begins: {plan}")

    monkeypatch.setattr(run, "drive", drive)
    monkeypatch.setenv("GIRAFF_CONFIG", str(shipped := ROOT / "deploy" / "robot.toml"))
    monkeypatch.chdir(tmp_path)
    Path(BAD_SCRIPT).write_text("0,0,0,9.81\n1,up,0,9.81\n", encoding="utf-8")
    Path(BAD_FILE).write_text(shipped.read_text().replace("[ranger]\nport", "[ranger]\nprot"), encoding="utf-8")
    code, out, err = giraff("run", "--local", *options)
    assert (code, out) == (2, "")
    [line] = err.splitlines()
    assert told in line
