"""Commands that write or tell something tell it to programs, too: one JSON document, and nothing else."""

import io
import json
import re
import sys
from pathlib import Path

import pytest

from giraff_tools.terminal.document import Report, print_report
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.test_any_command import whole_commands
from tests.unit.cli.typed import Giraff

BALANCER = str(ROOT / "deploy" / "robots" / "balancer.toml")
ROOM = str(ROOT / "deploy" / "worlds" / "living_room.toml")
STOP = dict.fromkeys(("engaged", "off", "latch", "by", "reason"))


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (("keys", "init", "--folder", "keys"), 0, {"folder": "keys"}),
        (("map", "show", ROOM), 0, {"svg": None}),
        (("map", "convert", ROOM, "out.yaml"), 0, {"file": "out.yaml", "image": "out.pgm", "resolution": 0.05}),
        (
            ("encoder", "disk", "disk.svg", "--pairs", "20"),
            0,
            {"file": "disk.svg", "states_per_turn": 80, "ticks_per_turn": 40},
        ),
        (("tune", "balance", "--file", BALANCER), 0, {"robot_file": BALANCER}),
        (("estop", "status", "--robot", "x", "--timeout", "0.1"), 2, {"robot": "x", "code": 2, **STOP}),
        (("estop", "engage", "--robot", "x", "--timeout", "0.5"), 2, {"robot": "x", "code": 2, **STOP}),
        (
            ("odom", "reset", "--robot", "x", "--timeout", "0.1"),
            2,
            {"robot": "x", "code": 2, "done": None, "yaw": None},
        ),
    ],
    ids=lambda words: " ".join(words[:2]) if isinstance(words, tuple) else "",
)
def test_it_is_one_document(
    words: tuple[str, ...],
    code: int,
    told: dict[str, object],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    giraff: Giraff,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GIRAFF_CONFIG", raising=False)
    meet(monkeypatch)
    ended, out, _ = giraff(*words, "--json")
    assert ended == code
    assert json.loads(out).items() >= told.items()


def test_each_command_stands_in_the_one_table() -> None:
    section = re.search(r"^## --json$(.+?)^## ", (ROOT / "docs" / "tools.md").read_text(), re.MULTILINE | re.DOTALL)
    assert section is not None
    rows = [line.split("|")[1] for line in section[1].splitlines() if line.startswith("| ")][1:]
    told = {verb: row.startswith(" no `--json`") for row in rows for verb in re.findall(r"`([a-z][a-z0-9 ]*)`", row)}
    assert sum(row.count("`") for row in rows) == 2 * (len(told) + sum("no `--json`" in row for row in rows))
    assert told == {
        path: all("--json" not in parameter.opts for parameter in command.params)
        for path, command in whole_commands().items()
    }


def test_talk_stays_out_of_the_document(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("yes\n"))

    def act(report: Report) -> int:
        print("told")
        report({"written": input("Write it?")})
        return 1

    assert print_report(act, as_json=True) == 1
    said = capsys.readouterr()
    assert (json.loads(said.out), said.err) == ({"written": "yes"}, "told\nWrite it?")
    assert print_report(lambda _: 2, as_json=True) == 2
    assert capsys.readouterr().out == ""
