"""Where `giraff estop engage` tries to stop a robot whose robot file or environment cannot be used."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from unittest.mock import MagicMock

import msgspec
import pytest
import zenoh

from giraff_cli.estop import engage
from giraff_cli.estop.plan import plan_stop
from giraff_core.network import NetworkConfig
from giraff_node.network.discovery import Target
from giraff_schemas.health import WebPage
from giraff_tools.network import command
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.pages import page_file
from tests.rules.repository import ROOT

DEFAULT = NetworkConfig()
FIXED = NetworkConfig(mode="fixed", connect=("10.0.0.5",))
NETWORK = b'\n[network]\nmode = "fixed"\nconnect = ["10.0.0.5"]\n'
ACCESS = b'[network.access]\nrobot = ["pi"]\n'
SECURED = '[network]\nmode = "secured"\n'


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "robot.toml"


def aim(path: Path, robot: str | None = "anne", **variables: str) -> tuple[str, NetworkConfig] | None:
    """Whom the plan asks, and where, in doubt; None: nobody."""
    target, doubt, complaint = plan_stop(robot, (), {"GIRAFF_CONFIG": str(path), **variables})
    assert doubt == f"whether it is yours is not known: {path} cannot be read"
    assert "use the battery switch, or without the file: env GIRAFF_CONFIG=/dev/null " in complaint
    assert ("NOTHING IS STOPPED FOR SURE" in complaint) == (target is not None)
    return None if target is None else (target.robot, target.network)


@pytest.mark.parametrize(
    ("content", "network"),
    [
        (b"[guard\nmargin = 1" + NETWORK, FIXED),  # a header without its end
        (b"# K\xfcche" + NETWORK, FIXED),  # another encoding
        (b"\xef\xbb\xbf[robot" + NETWORK, FIXED),  # the mark that an editor left
        (b"\0\0\0" + NETWORK, FIXED),  # a disk that has lost a block
        (NETWORK + b"connect = []\n[guard]\nmargin = = 1", FIXED),  # a line twice
        (b"[network]\nmode = fixed\nrendezvous = '127.0.0.1:9'", NetworkConfig(rendezvous="127.0.0.1:9")),
        (b"[network\n" + NETWORK.replace(b'["', b'["robot:abc", "'), FIXED),
        (b"[network", DEFAULT),
        (b'[network]\nmode = "fxied"\nlocal = true', NetworkConfig(local=True)),
        (b'[network]\nmode = "lna"', NetworkConfig()),
        (b'[robot]\nname = "a/b"' + NETWORK, FIXED),
        (b'[robot]\nnmae = "anne"' + NETWORK, FIXED),
        (b"x = " + b"[" * 2000 + NETWORK, FIXED),
        (NETWORK.decode().encode("utf-16"), FIXED),  # an editor of Windows
        (b"\x1f\x8b\x08\0\0\0\0\0\0\xff\x8b.-\xca/\xaf", DEFAULT),  # packed: it says nothing
        (Path("deploy/robot.toml").read_bytes() + b"[guard", DEFAULT),
        (b'[network]\nsession_file = "s.json5"\n[guard', NetworkConfig(session_file="s.json5")),  # it alone counts
        (b"#[network]\n # mode = 'secured'\r#keys = 'k'\n[guard", DEFAULT),
    ],
)
def test_a_broken_file_is_tried_over_all_that_can_be_read_of_it(
    path: Path, content: bytes, network: NetworkConfig
) -> None:
    """And of every robot there, as nobody has named one."""
    path.write_bytes(content)
    assert aim(path, None) == ("", network)


UNREADABLE: dict[str, Callable[[Path], object]] = {
    "folder": Path.mkdir,
    "link": partial(Path.symlink_to, target="nowhere"),
    "pipe": os.mkfifo,
}


@pytest.mark.parametrize("kind", UNREADABLE)
def test_a_file_that_cannot_be_read_is_tried_over_the_environment_and_the_defaults(path: Path, kind: str) -> None:
    UNREADABLE[kind](path)
    assert aim(path) == ("anne", DEFAULT)
    assert aim(path, GIRAFF_NETWORK_CONNECT='["10.0.0.5"]', GIRAFF_NETWORK_MODE="fixed") == ("anne", FIXED)


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
        b'[network]\nmode = "scured"',
        b'[network]\nmode = "secrued"',
        b'[network]\nmode = "encrypted"',
        b'[network]\nmode = "lan encrypted"',
        '[network]\nmode = "\u0455ecured"'.encode(),
        b'[network]\nmode = "sec',
        b'[network]\nmode = "scured"\nmode = "lan"',
        b'[network]\nmode = "lan"\n[guard]\nmode = "encrypted"',
        b'[network]\nmode = "scured"\nrouter = "r.example.org"\nsite = "lab"',
        b'[network]\n[network.acces]\nrobot = ["pi"]',
        b'[network]\nmode = "scured"\nkeys = "/media/keys"',
        b'[network]\nkeys = "/media/keys"\nlocla = true',
        b'[network]\nsession_file = ""\nmode = "scured"',
        b'[network]\nsession_fil = "/etc/zenoh.json5"',
        b"[guard\n[acess]",
        b'network = { keys = "/etc/#1", mode = "secured" }\n[guard',
        b'network = { site = "#1", mode = "secured" }\n[guard',
        b'# as the others\rmode = "secured"\r[guard',
        *(SECURED.encode(letters) for letters in ("utf-16", "utf-16-be", "utf-32", "utf-32-be")),
    ],
)
def test_what_looks_secured_is_never_tried_without_its_rules(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    assert aim(path) is None


@pytest.mark.parametrize("mode", [b'mode = "secured"\n', b'mode = "secure"\n', b"mode =\n"])
def test_with_its_rules_it_is_tried_with_certificates_alone(
    path: Path, mode: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(zenoh, "open", pytest.fail)
    path.write_bytes(b"[network]\n" + mode + ACCESS + b"[guard")
    _, network = aim(path, GIRAFF_NETWORK_KEYS=str(path.parent)) or ("", DEFAULT)
    assert (network.mode, network.access.robot) == ("secured", ("pi",))
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    monkeypatch.setenv("GIRAFF_NETWORK_KEYS", str(path.parent))
    assert engage.engage_by_plan("anne", (), "", 1.0) == 2
    first, _ = capsys.readouterr().err.splitlines()
    assert first.startswith("giraff: NOTHING IS STOPPED: use the battery switch; ")
    assert "the network is secured: put this host's bundle" in first


def test_a_robot_that_was_visited_is_missed_though_only_the_example_names_it(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STATE_DIRECTORY", str(path.parent))
    monkeypatch.chdir(ROOT)
    plan = plan_stop(None, (), {})
    assert plan.target is not None
    assert (plan.target.robot, plan.target.filed) == ("", "")
    page_file("giraff").write_bytes(msgspec.json.encode((WebPage(port=8443, hosts=("10.0.0.5",), certificate="ab"),)))
    plan = plan_stop(None, (), {})
    assert plan.target is not None
    assert (plan.target.robot, plan.target.filed) == ("", "giraff")


def test_nothing_is_said_before_the_stop(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever reads it may stand still."""
    order: list[str] = []

    def visit(*_: object, **__: object) -> int:
        order.append("stop")
        return 0

    monkeypatch.setattr(engage, "visit", visit)
    monkeypatch.setattr(engage, "print_error", lambda text: order.append(text.partition(":")[0]))
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    for content, told in ("[gaurd]", "not everything of robot file and environment counts"), ("[", str(path)):
        path.write_text(content, encoding="utf-8")
        engage.engage_by_plan("anne", ("no address",), "", 1.0)
        assert order == ["stop", told]
        order.clear()


def test_an_exception_that_nobody_foresaw_leaves_the_network(monkeypatch: pytest.MonkeyPatch) -> None:
    def act(_: RobotConnection) -> int:
        raise EndedError

    closed: list[str] = []
    monkeypatch.setattr(command, "open_session", lambda *_, **__: MagicMock(name="session"))
    monkeypatch.setattr(RobotConnection, "close", lambda *_: closed.append("closed"))
    with pytest.raises(EndedError):
        command.visit(Target("anne", DEFAULT), act)
    assert closed == ["closed"]


class EndedError(Exception):
    """In the place of a session."""
