"""What a run prints to be pasted: in any folder, and with no word too many."""

import shlex
import sys
from pathlib import Path

import pytest

from giraff_cli.run.begin import Invitation, invite
from giraff_core.network import NetworkConfig
from giraff_tools.network.interfaces import Interface
from giraff_tools.terminal.program import called_anywhere

AT = "127.0.0.1:23456"
WIRED = Interface(name="eth0", address="192.168.1.7/24", multicast=True)
TUNNEL = Interface(name="tun0", address="10.0.0.7/24", multicast=False)
FILE = Path("/etc/giraff/my robot.toml")


def invited(
    network: NetworkConfig, *interfaces: Interface, is_only_here: bool = True, giraff: str = "giraff"
) -> Invitation:
    return invite([giraff], "sim-here", network, FILE, interfaces=interfaces, is_only_here=is_only_here)


@pytest.mark.parametrize(
    ("invitation", "line"),
    [
        (invited(NetworkConfig(rendezvous=AT), TUNNEL, WIRED), "giraff drive"),
        (invited(NetworkConfig(rendezvous=AT), WIRED, is_only_here=False), "giraff drive --robot sim-here"),
        (invited(NetworkConfig(rendezvous=AT), TUNNEL), f"giraff drive --connect {AT}"),
        (invited(NetworkConfig(rendezvous=AT)), f"giraff drive --connect {AT}"),
        (invited(NetworkConfig(rendezvous=AT), is_only_here=False), f"giraff drive --robot sim-here --connect {AT}"),
        (invited(NetworkConfig(rendezvous=AT, local=True), WIRED), f"giraff drive --connect {AT}"),
        (invited(NetworkConfig(rendezvous=AT, connect=("10.0.0.2",)), WIRED), f"giraff drive --connect {AT}"),
        (
            invited(NetworkConfig(rendezvous=AT, mode="fixed"), WIRED),
            f"'GIRAFF_CONFIG={FILE}' giraff drive --robot sim-here --connect {AT}",
        ),
        (
            invited(NetworkConfig(rendezvous=AT, session_file="/etc/zenoh.json5"), WIRED),
            f"'GIRAFF_CONFIG={FILE}' giraff drive --robot sim-here",
        ),
        (invited(NetworkConfig(rendezvous=AT), WIRED, giraff="/my clone/giraff"), "'/my clone/giraff' drive"),
    ],
)
def test_robot_address_and_file_are_named_where_they_are_needed(invitation: Invitation, line: str) -> None:
    assert invitation.command("drive") == line


def test_it_says_how_to_drive_stop_ask_and_watch() -> None:
    lines = invited(NetworkConfig(rendezvous=AT), WIRED).lines()
    assert lines == ["giraff drive", "giraff stop", "giraff why", "giraff watch"]


@pytest.fixture
def program(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """`giraff` beside its Python, and on nobody's path."""
    made = tmp_path / "bin" / "giraff"
    made.parent.mkdir()
    made.write_text("#!/bin/sh\n")
    made.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(made.with_name("python")))
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.delenv("VIRTUAL_ENV", raising=False)
    return made


def test_the_program_is_called_by_a_path_that_holds_in_any_folder(program: Path) -> None:
    assert called_anywhere() == [str(program)]


def test_it_is_called_by_its_name_where_every_shell_finds_it(
    program: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(program.parent))
    assert called_anywhere() == ["giraff"]
    monkeypatch.setenv("VIRTUAL_ENV", str(tmp_path))
    assert called_anywhere() == [str(program)], "another terminal has not activated it"
    monkeypatch.delenv("VIRTUAL_ENV")
    another = tmp_path / "another" / "giraff"
    another.parent.mkdir()
    another.write_text("#!/bin/sh\n")
    another.chmod(0o755)
    monkeypatch.setenv("PATH", str(another.parent))
    assert called_anywhere() == [str(program)], "an older one is found by that name"


def test_without_a_program_its_package_is_called(program: Path) -> None:
    program.unlink()
    assert shlex.join(called_anywhere()) == f"{sys.executable} -m giraff_cli"


@pytest.mark.parametrize(("library", "line"), [("rerun", "camera view"), (None, "camera view --save look.jpg")])
def test_a_run_with_a_camera_tells_how_to_see_by_it_with_what_is_installed(
    library: str | None, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("giraff_cli.run.begin.find_spec", lambda _: library)
    invitation = invited(NetworkConfig(rendezvous=AT), WIRED)
    assert invitation.lines(camera=True) == [*invitation.lines(), f"giraff {line}"]
    assert invitation.how_to_see.endswith(f"giraff {line}")
