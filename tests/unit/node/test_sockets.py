"""Sockets at which processes of one host meet, and those that dead ones have left."""

import fcntl
import os
import socket
from pathlib import Path

import pytest

from giraff_core.network import NetworkConfig
from giraff_node.network import sockets


@pytest.mark.parametrize("is_alive", [True, False])
def test_a_dead_process_of_another_user_keeps_no_socket(
    is_alive: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # the path of a socket has 107 bytes at most
    path, lock = Path("rendezvous"), Path("rendezvous.lock")

    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(fcntl, "flock", refuse)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(path))
        listening.listen()
        lock.touch()
        os.utime(lock, (0, 0))
        if not is_alive:
            listening.close()
        sockets.own_socket(Path(), "base")
    assert (path.exists(), lock.exists()) == (is_alive, is_alive)


def test_only_the_rendezvous_of_this_network_counts_and_only_while_somebody_listens(tmp_path: Path) -> None:
    ours, other, dialled, remote = (
        NetworkConfig(rendezvous=f"127.0.0.1:{port}", sockets=str(tmp_path), connect=connect)
        for port, connect in ((7001, ()), (7002, ()), (7001, ("127.0.0.1:7002",)), (7001, ("192.168.1.5:7002",)))
    )
    with (sockets.socket_folder(other) / "rendezvous.lock").open("wb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert [sockets.live_rendezvous(each) for each in (ours, remote)] == [[], []]
        assert [sockets.live_rendezvous(each) for each in (other, dialled)] == [[tmp_path / "7002" / "rendezvous"]] * 2
    assert sockets.live_rendezvous(other) == []
