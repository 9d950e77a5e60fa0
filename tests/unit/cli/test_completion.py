"""What a shell is told at the TAB key: of the network where a robot answers, else of the tables, and nothing else."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer.main
import zenoh

from giraff_cli.completion import answer
from giraff_cli.completion.answer import print_candidates
from giraff_cli.main import app
from giraff_schemas.codec import encode
from giraff_schemas.health import Health
from giraff_schemas.params import Param, ParamAnswer
from giraff_schemas.topics import alive_key
from tests.unit.cli.quiet_network import alone, meet
from tests.unit.cli.test_any_command import whole_commands

HOSTILE = ("x;reboot", "$(reboot)", "`reboot`", "a\nb", "\x1b]0;x\a", "--for", "-x", "a b", "'", "é")
TOKENS = (alive_key("otto", "guard", "1"), alive_key("otto", "ear", "2"), alive_key("sim-test", "base", "3"))
COMMAND = typer.main.get_command(app)


def completed(capsys: pytest.CaptureFixture[str], *words: str) -> list[str]:
    """Return the words that a shell is told."""
    capsys.readouterr()
    print_candidates(COMMAND, words)
    said = capsys.readouterr()
    assert said.err == ""
    return [line.partition("\t")[0] or line for line in said.out.splitlines()]


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Two robots; all that answers has hostile names, too."""
    alone(monkeypatch, tmp_path)
    quiet = meet(monkeypatch, *TOKENS, *(f"giraff/{name}/alive/base/x" for name in ("x;reboot", "`reboot`", "a\nb")))
    opened = quiet.open

    def reply(key: str, handler: Any, **_: Any) -> None:
        answered = _params() if "/param/" in key else _health()
        handler.callback(SimpleNamespace(ok=SimpleNamespace(payload=answered)))
        handler.callback(SimpleNamespace(ok=SimpleNamespace(payload=b"\xc1")))
        handler.drop()

    def open_(config: Any) -> Any:
        session = opened(config)
        session.get.side_effect = reply
        return session

    monkeypatch.setattr(zenoh, "open", open_)


def _params() -> bytes:
    names = ("margin", "maker_depth", "robot.track_width", *HOSTILE)
    live = dict.fromkeys(names, "up") | {"maker_fixed": "fixed"}
    params = [
        Param(name=name, value=1, filed=1, saved=True, kind="", live=may, doc="")  # type: ignore[arg-type]
        for name, may in live.items()
    ]
    return encode(ParamAnswer(service="guard", instance="1", host="pi", done=True, params=tuple(params)))


def _health() -> bytes:
    spoken = ("odom", "maker/arm", *HOSTILE)
    return encode(
        Health(service="guard", instance="1", host="pi", pid=1, uptime=1, ok=True, faults=(), publishes=spoken)
    )


@pytest.mark.usefixtures("network")
@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("topic echo --robot |", ["otto", "sim-test"]),
        ("stop |", ["otto", "sim-test"]),
        ("estop engage otto s|", ["sim-test"]),
        ("estop r|", ["reset"]),
        ("topic echo --robot=s|", ["--robot=sim-test"]),
        ("topic echo --robot = s|", ["sim-test"]),
        ("topic echo |", ["maker/arm", "odom"]),
        ("record --topics ma|", ["maker/arm"]),
        ("node info --robot otto |", ["ear", "guard"]),
        ("param get |", ["base.", "guard."]),
        ("param set guard.ma|", ["guard.maker_depth", "guard.margin"]),
        ("param get guard.maker|", ["guard.maker_depth", "guard.maker_fixed"]),
        ("param get robot.|", ["robot.track_width"]),
    ],
)
def test_the_network_is_asked(words: str, told: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert completed(capsys, *words[:-1].split(" ")) == told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("wat|", ["watch"]),
        ("topic ec|", ["echo"]),
        ("topic echo --ro|", ["--robot"]),
        ("run --boards |", ["avr", "host"]),
        ("topic pub bat|", ["battery"]),
        ("topic echo range|", ["range/*"]),
        ("node info gu|", ["guard"]),
        ("param set guard.marg|", ["guard.margin"]),
        ("param get bas|", ["base."]),
        ("param get guard.half|", ["guard.half_cone"]),
        ("param set guard.half|", []),
        ("topic echo --robot |", []),
        ("play |", ["\tfile"]),
        ("go |", ["\tfile"]),
        ("wach |", []),
        ("topic eco |", []),
        ("why extra words |", []),
        ("topic echo odom --for 1 2 3 \x1b|", []),
    ],
)
@pytest.mark.parametrize("file", ["", "[network\n", "[network]\nmode = 3\n", None])
def test_without_a_network_and_with_any_robot_file_the_tables_tell(
    words: str,
    told: list[str],
    file: str | None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def refuse(_config: Any) -> Any:
        raise zenoh.ZError("nobody")

    path = tmp_path / "robot.toml"
    if file is not None:
        path.write_text(file)
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.setattr(answer, "_WITHIN", 0.05)
    monkeypatch.setattr(zenoh, "open", refuse)
    assert completed(capsys, *words[:-1].split(" ")) == told


def test_a_network_that_hangs_is_not_waited_for(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    waited: list[float] = []
    hanging = SimpleNamespace(start=lambda: None, join=waited.append)
    monkeypatch.setattr("threading.Thread", lambda **_: hanging)
    assert completed(capsys, "node", "info", "gu") == ["guard"]
    assert waited == [0.5]


def test_each_source_is_of_a_parameter_that_there_is() -> None:
    takers = {(path.split()[0], parameter.name) for path, it in whole_commands().items() for parameter in it.params}
    assert set(answer._SOURCES) <= takers
    assert {(verb, name) for verb, name in takers if name in {"key", "topics"}} <= set(answer._SOURCES)
