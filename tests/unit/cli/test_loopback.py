"""A host whose loopback is down, as in a container's fresh network: it is named at once, with the remedy."""

import errno
import socket
from pathlib import Path
from typing import Any

import pytest

from giraff_node.network.discovery import not_found_text
from giraff_node.network.host_addresses import loopback_fault
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import alone, meet
from tests.unit.cli.typed import Giraff

DOWN = "this host's loopback is down"
UP = "type: sudo ip link set lo up"


class Unplugged(socket.socket):
    def connect_ex(self, _address: Any) -> int:
        return errno.ENETUNREACH


def test_it_is_named_at_once(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, tmp_path: Path) -> None:
    alone(monkeypatch, tmp_path)
    network = meet(monkeypatch)
    assert not loopback_fault()
    monkeypatch.setattr(socket, "socket", Unplugged)
    robot_file = str(ROOT / "deploy" / "robot.toml")
    code, out, told = giraff("run", "--file", robot_file, "--boards", "host", "--for", "1")
    assert (code, out, network.opened) == (2, "", 0)
    assert told == f"giraff run: {DOWN}, where the robot's parts meet; {UP}\n"
    assert not_found_text("otto", ()) == f"no robot called otto is heard on the network; {DOWN}; {UP}"
    _, out, _ = giraff("doctor")
    assert f"no robot is heard: {DOWN}" in out
    assert f"-> {UP}" in out
