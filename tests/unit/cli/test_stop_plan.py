"""Where `giraff estop engage` tries to stop a robot whose robot file or environment cannot be used."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import zenoh

from giraff_cli.estop.attempts import engage_by_plan
from giraff_cli.estop.plan import plan_stop
from giraff_cli.network import command
from giraff_cli.network.connection import RobotConnection
from giraff_core.network import NetworkConfig
from giraff_node.network.discovery import Target

DEFAULT = NetworkConfig()
FIXED = NetworkConfig(mode="fixed", connect=("10.0.0.5",))
NETWORK = b'\n[network]\nmode = "fixed"\nconnect = ["10.0.0.5"]\n'
ACCESS = b'[network.access]\nrobot = ["pi"]\n'


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "robot.toml"


def attempts(path: Path, robot: str | None = "anne", **variables: str) -> list[tuple[str, NetworkConfig]]:
    """Whom the plan asks, and where, with each in doubt."""
    plan = plan_stop(robot, (), {"GIRAFF_CONFIG": str(path), **variables})
    assert all(f"{path} cannot be read, so whether it is yours is not known" == doubt for _, doubt in plan.attempts)
    assert "use the battery switch, or without the file: env GIRAFF_CONFIG=/dev/null " in plan.complaint
    assert ("NOTHING IS STOPPED FOR SURE" in plan.complaint) == bool(plan.attempts)
    return [(target.robot, target.network) for target, _ in plan.attempts]


@pytest.mark.parametrize(
    ("content", "network"),
    [
        (b"[guard\nmargin = 1" + NETWORK, FIXED),  # a header without its end
        (b"# K\xfcche" + NETWORK, FIXED),  # another encoding
        (b"\xef\xbb\xbf[robot]" + NETWORK, FIXED),  # the mark that an editor left
        (b"\0\0\0" + NETWORK, FIXED),  # a disk that has lost a block
        (NETWORK + b"connect = []\n[guard]\nmargin = = 1", FIXED),  # a line twice
        (b"[network]\nmode = fixed\nrendezvous = '127.0.0.1:9'", NetworkConfig(rendezvous="127.0.0.1:9")),
        (b"[network", DEFAULT),
        (b'[network]\nmode = "fxied"\nlocal = true', NetworkConfig(local=True)),
        (b'[robot]\nname = "a/b"' + NETWORK, FIXED),
        (b'[robot]\nnmae = "anne"' + NETWORK, FIXED),
        (b"x = " + b"[" * 2000 + NETWORK, FIXED),
    ],
)
def test_a_broken_file_is_tried_over_all_that_can_be_read_of_it(
    path: Path, content: bytes, network: NetworkConfig
) -> None:
    """And of every robot there, as nobody has named one."""
    path.write_bytes(content)
    first, *others = attempts(path, None)
    assert first == ("", network)
    other = NetworkConfig(connect=network.connect, local=network.local)
    assert others == ([] if other == network else [("", other)])


UNREADABLE: dict[str, Callable[[Path], object]] = {
    "folder": Path.mkdir,
    "link": partial(Path.symlink_to, target="nowhere"),
    "pipe": os.mkfifo,
}


@pytest.mark.parametrize("kind", UNREADABLE)
def test_a_file_that_cannot_be_read_is_tried_over_the_environment_and_the_defaults(path: Path, kind: str) -> None:
    UNREADABLE[kind](path)
    assert attempts(path) == [("anne", DEFAULT)]
    assert attempts(path, GIRAFF_NETWORK_CONNECT='["10.0.0.5"]', GIRAFF_NETWORK_MODE="fixed")[0] == ("anne", FIXED)


@pytest.mark.parametrize(
    "content",
    [
        b'[network]\nmode = "secured',
        b'[network]\nmdoe = "secured"\nmode = "lan"',
        b'[netwrok]\nmode = "secured"',
        b'mode = "secured"\n[guard',
        b'[network]\nmode = "secured"\nmode = "lan"',
        b'[network]\nmode = "lan"\n[guard]\nmode = "secured"',
        b'[network]\nmode = "secure"',
        b'network = { mode = "secured" }\n[guard',
        b"[network]\nconnect = ['tls/pi:7447']",
        b"[guard\n" + ACCESS.replace(b"]\n", b"\n"),
    ],
)
def test_what_looks_secured_is_never_tried_without_its_rules(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    assert attempts(path) == []


@pytest.mark.parametrize("mode", [b'mode = "secured"\n', b'mode = "secure"\n', b"mode =\n"])
def test_with_its_rules_it_is_tried_with_certificates_alone(
    path: Path, mode: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(zenoh, "open", pytest.fail)
    path.write_bytes(b"[network]\n" + mode + ACCESS + b"[guard")
    [(_, network)] = attempts(path, GIRAFF_NETWORK_KEYS=str(path.parent))
    assert (network.mode, network.access.robot) == ("secured", ("pi",))
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    monkeypatch.setenv("GIRAFF_NETWORK_KEYS", str(path.parent))
    assert engage_by_plan("anne", (), "", 1.0) == 2
    first, *more = capsys.readouterr().err.splitlines()
    assert first == "giraff: NOTHING IS STOPPED: use the battery switch"
    assert "the network is secured: put this host's bundle" in more[0]


def test_a_sound_file_whose_network_cannot_be_opened_is_told_after_a_stop_over_the_defaults(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path.write_text('[network]\nrendezvous = "nonsense"', encoding="utf-8")
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    order: list[str] = []

    def opened(way: Target, **_: Any) -> RobotConnection:
        order.append(way.network.rendezvous)
        if way.network.rendezvous == "nonsense":
            raise command.UnopenedError("no Zenoh session: nonsense")
        raise EndedError

    monkeypatch.setattr("giraff_cli.estop.attempts.print_error", order.append)
    monkeypatch.setattr(command, "_opened", opened)
    with pytest.raises(EndedError):
        engage_by_plan("anne", (), "", 1.0)
    assert order == ["nonsense", DEFAULT.rendezvous], "nothing is said before the stop"


class EndedError(Exception):
    """In the place of a session."""
