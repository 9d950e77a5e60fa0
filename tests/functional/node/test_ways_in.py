"""A port of a door at which nobody answers, because others call there all the time."""

import socket
from contextlib import closing
from pathlib import Path

import pytest

from giraff_core.network import NetworkConfig, door_ports
from giraff_node.network.session import NobodyError, close_session, open_clients, open_session
from giraff_ros2.rmw.session import open_ros
from giraff_tools.network.ports import free_port

ROBOT = "sim-node"


def test_a_client_comes_in_by_another_port_of_the_door(tmp_path: Path) -> None:
    usual = f"127.0.0.1:{free_port()}"
    further = door_ports(usual)[1]
    client = NetworkConfig(mode="fixed", rendezvous=usual, sockets=str(tmp_path / "laptop"))
    with socket.create_server(("127.0.0.1", int(usual.rpartition(":")[2]))):  # it takes calls, and says nothing
        with pytest.raises(NobodyError):
            next(open_clients(client, ROBOT))
        door = open_session(
            NetworkConfig(mode="fixed", rendezvous=further, sockets=str(tmp_path / "robot")), ROBOT, "door", visits=True
        )
        try:
            _, session = next(open_clients(client, ROBOT))
            assert [str(zid) for zid in session.info.peers_zid()] == [str(door.zid())]
            close_session(session)
        finally:
            close_session(door)


def test_a_router_of_ros_at_the_port_of_the_door_is_no_door(tmp_path: Path) -> None:
    usual = f"127.0.0.1:{free_port()}"
    client = NetworkConfig(mode="fixed", rendezvous=usual, sockets=str(tmp_path / "laptop"))
    with closing(open_ros(usual).session), pytest.raises(NobodyError):
        next(open_clients(client, "*"))
