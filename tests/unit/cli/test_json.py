"""Commands that write or tell something tell it to programs, too."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import typed

ROOM = str(ROOT / "deploy" / "worlds" / "living_room.toml")
STOP = dict.fromkeys(("engaged", "off", "latch", "by", "reason"))


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (("keys", "init", "--folder", "keys"), 0, {"folder": "keys"}),
        (("map", "show", ROOM), 0, {"svg": None}),
        (("map", "convert", ROOM, "out.yaml"), 0, {"file": "out.yaml", "image": "out.pgm", "resolution": 0.05}),
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
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GIRAFF_CONFIG", raising=False)
    meet(monkeypatch)
    ended, out, _ = typed(monkeypatch, capsys, *words, "--json")
    assert ended == code
    assert json.loads(out).items() >= told.items()
