"""Which parameter somebody means: of a whole table, of a bare field, of a name that is mistyped."""

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec
import pytest

from giraff_cli.param import client
from giraff_schemas.params import Param, ParamAnswer
from giraff_schemas.topics import alive_key
from giraff_schemas.trouble import Trouble
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff

VALUES: Mapping[str, Mapping[str, Any]] = {
    "guard": {"margin": 0.25, "release": 2, "robot.track_width": 0.5},
    "base": {"port": "/dev/base", "drive.k1": 744.0, "drive.k2": 174.8},
    "ranger": {"port": "/dev/ranger"},
}


def answer(service: str) -> ParamAnswer:
    params = tuple(
        Param(name=name, value=value, filed=value, saved=True, kind="", live="free", doc="")
        for name, value in VALUES[service].items()
    )
    return ParamAnswer(service=service, instance="one", host="pc", done=True, params=params)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("get", "guard.margin"), "0.25\n"),
        (("get", "guard"), "parameter      live  value\nguard.margin   yes   0.25\nguard.release "),
        (("get", "base.drive"), "parameter      live  value\nbase.drive.k1  yes   744\nbase.drive.k2  yes   174.8\n"),
        (("get", "ranger"), "parameter    live  value\nranger.port  yes   /dev/ranger\n"),
        (("get", "margin"), "giraff: margin: name the service too, like guard.margin\n"),
        (("set", "margin", "0.3"), "giraff: margin: name the service too, like guard.margin\n"),
        (("save", "port"), "giraff: port: name the service too, like base.port or ranger.port\n"),
        (
            ("get", "gard.margin"),
            "gard.margin: no such parameter; did you mean guard.margin? there are base, guard, ran",
        ),
        (("list", "gard"), "giraff: gard: no such parameter; did you mean guard? there are base, guard, ranger"),
        (("get", "marign"), "giraff: marign: no such parameter; did you mean guard.margin? there are base, guard,"),
        (("describe", "guard.margn"), "no such parameter; did you mean guard.margin? guard has margin, release\n"),
        (("get", "robot.track_wdth"), "did you mean robot.track_width? robot has track_width\n"),
        (
            ("set", "gard.margin", "1"),
            "gard: no such service is heard of sim-test; did you mean guard? there are base, ",
        ),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, tuple) else "",
)
def test_what_is_meant_is_told(
    words: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    def ask(_connection: Any, _query: Any, requests: Iterable[str], _patience: float) -> dict[str, ParamAnswer]:
        return {service: answer(service) for service in requests}

    monkeypatch.setattr(client, "_ask", ask)
    meet(monkeypatch, *(alive_key("sim-test", service, service) for service in VALUES))
    code, out, complaint = giraff("param", *words, "--robot", "sim-test")
    assert told in out + complaint
    assert (code, bool(out), complaint.count("\n")) == ((0, True, 0) if out else (2, False, 1))


@pytest.mark.parametrize(("mistyped", "code"), [(True, 2), (False, 1)])
def test_nothing_is_tried_with_what_is_mistyped(
    mistyped: bool, code: int, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    said = msgspec.structs.replace(answer("guard"), done=False, reason=Trouble("no"), params=(), mistyped=mistyped)
    monkeypatch.setattr(client, "_ask", lambda *_: {"guard": said})
    meet(monkeypatch, alive_key("sim-test", "guard", "guard"))
    for words in (("set", "guard.margin", "30cm"), ("save", "guard.marign")):
        assert giraff("param", *words, "--robot", "sim-test") == (code, "", "giraff: no\n")
