"""Sockets that dead processes have left."""

from __future__ import annotations

import fcntl
import os
import socket
from pathlib import Path

import pytest

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
