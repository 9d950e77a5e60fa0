"""What a session is told of the network that it is to be on."""

import json
import socket
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple, get_args

import msgspec
import pytest
import zenoh

from giraff_core.network import NetworkConfig, door_ports, with_port
from giraff_node.config.robot_file import ConfigError
from giraff_node.network import scouting
from giraff_node.network.scouting import find_doors
from giraff_node.network.session import Role, session_config, way_to

ROBOT = "sim-node"


def test_a_local_session_stays_on_the_loopback() -> None:
    for role in get_args(Role):
        config = session_config(NetworkConfig(local=True, connect=("192.0.2.1",)), ROBOT, role)
        endpoints = config.get("listen", {}).get("endpoints", []) + config["connect"]["endpoints"]
        assert all(endpoint.startswith(("tcp/127.0.0.1:", "unixsock-stream/")) for endpoint in endpoints)
        assert config["scouting"]["multicast"]["enabled"] is False


def test_a_session_on_the_network_scouts_and_connects() -> None:
    config = session_config(NetworkConfig(connect=("192.0.2.1",)), ROBOT, "door")
    assert config["connect"]["endpoints"] == ["tcp/192.0.2.1:7447", "tcp/127.0.0.1:7447"]
    assert config["scouting"]["multicast"]["enabled"] is True


def test_the_configuration_is_one_that_zenoh_takes() -> None:
    for role in get_args(Role):
        zenoh.Config.from_json5(json.dumps(session_config(NetworkConfig(), ROBOT, role)))


def test_a_command_goes_to_a_door_where_no_socket_can_be_used() -> None:
    nowhere = NetworkConfig(sockets="/proc/nowhere", connect=("192.0.2.1",))
    config = session_config(nowhere, ROBOT, "client")
    assert config["connect"]["endpoints"] == ["tcp/192.0.2.1:7447", "tcp/127.0.0.1:7447"]
    with pytest.raises(ConfigError, match="let sockets in"):
        session_config(nowhere, ROBOT, "inside")


def test_who_is_inside_listens_to_its_own_host_alone() -> None:
    config = session_config(NetworkConfig(), ROBOT, "inside")
    assert all(endpoint.startswith("unixsock-stream/") for endpoint in config["listen"]["endpoints"])
    assert config["scouting"]["multicast"]["enabled"] is False
    assert config["scouting"]["delay"] == 0, "a start would wait 0.2 s for a door that is not there"


@pytest.mark.parametrize("role", ["door", "outside", "apart"])
def test_a_peer_that_others_dial_has_no_socket(role: Role) -> None:
    """A robot's ranger had two links to its door, one at a socket, and believed what strangers said by the other."""
    config = session_config(NetworkConfig(), ROBOT, role)
    assert config["transport"]["link"]["protocols"] == ["tcp"]
    assert not [each for part in ("listen", "connect") for each in config[part]["endpoints"] if "unixsock" in each]


def test_a_door_listens_at_further_ports_and_a_client_knows_them() -> None:
    ports = [f"tcp/0.0.0.0:{port}#" for port in (7447, 7457, 7458, 7459)]
    listens = session_config(NetworkConfig(), ROBOT, "door")["listen"]["endpoints"]
    assert all(any(endpoint.startswith(port) for endpoint in listens) for port in ports)
    assert door_ports("192.0.2.1:7447") == tuple(f"192.0.2.1:{port}" for port in (7447, 7457, 7458, 7459))
    assert door_ports("[2001:db8::1]:65530") == ("[2001:db8::1]:65530",)
    assert not session_config(NetworkConfig(), ROBOT, "outside", port=7448)["listen"]["endpoints"][1:]


@pytest.mark.parametrize(
    ("address", "read"),
    [
        ("192.168.1.20", "192.168.1.20:7447"),
        ("tcp/robot_1.lan:1", "robot_1.lan:1"),
        ("[fd00::2]:7448", "[fd00::2]:7448"),
        ("[fd00::2]", "[fd00::2]:7447"),
        ("::1", "[::1]:7447"),
        ("fe80::1%eth0", "[fe80::1%eth0]:7447"),
    ],
)
def test_host_and_port_of_an_address_are_told_apart(address: str, read: str) -> None:
    assert with_port(address) == read
    NetworkConfig(connect=(address,), router=address, site="lab")


PORTS = (":", ":abc", ":99999", ":0", ":7447 ", ":٣")
NO_ADDRESSES = (
    " ",
    ":7447",
    "a b",
    " a",
    "http://a",
    "tls/a:1",
    "10.77.0.300",
    "7447",
    "a..b",
    "[a]:1",
    "[::1",
    "::1]",
    "-h",
    "٣.٣.٣.٣",
)


@pytest.mark.parametrize(
    ("address", "told"),
    [
        *((f"robot{port}", "is no port from 1 to 65535; give HOST or HOST:PORT") for port in PORTS),
        *((address, "is no address; give HOST or HOST:PORT") for address in (*NO_ADDRESSES, "a:1:2", "[::1]7447")),
        *(
            (host, "needs its interface, like fe80::1%eth0")
            for host in ("[fe80::1]:7447", "[FE81::1]", "febf::1", "fe80::1%25eth0")
        ),
    ],
)
def test_what_is_no_address_is_refused_by_each_field(address: str, told: str) -> None:
    for field in ("rendezvous", "connect", "router"):
        with pytest.raises(msgspec.ValidationError, match=rf"^{field}: '.*{told}"):
            msgspec.convert({field: [address] if field == "connect" else address, "site": "lab"}, NetworkConfig)


def test_a_rendezvous_has_a_port_and_is_ipv4_alone() -> None:
    for address in ("127.0.0.1", "[::1]:7447"):
        with pytest.raises(ValueError, match="give HOST:PORT by IPv4"):
            NetworkConfig(rendezvous=address)


def test_zenoh_is_told_an_interface_by_its_number() -> None:
    number, name = socket.if_nameindex()[0]
    assert way_to(NetworkConfig(), f"fe80::1%{name}") == f"tcp/[fe80::1%{number}]:7447"
    assert way_to(NetworkConfig(), "[fe80::1%none]:1") == "tcp/[fe80::1%none]:1"


class Hello(NamedTuple):
    zid: str
    locators: tuple[str, ...]


@pytest.mark.parametrize("role", ["inside", "outside"])
def test_a_visit_is_dialled_and_dials_where_it_is_told(tmp_path: Path, role: Role) -> None:
    """A link that it was opening while it closed stayed for good. Of two peers the one with the greater id dials."""
    network = NetworkConfig(sockets=str(tmp_path))
    visit = session_config(network, ROBOT, role, visits=True, dials=["tcp/10.0.0.3:7449"])
    assert visit["scouting"]["gossip"]["autoconnect"] == {"peer": []}
    assert "tcp/10.0.0.3:7449" in visit["connect"]["endpoints"]
    for other in get_args(Role)[:3]:
        peer = session_config(network, ROBOT, other)["id"]
        assert bytes.fromhex(visit["id"][-8:])[::-1] < bytes.fromhex(peer[-8:])[::-1]


def test_a_client_links_to_no_visit(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A visit ends within a second, and the link of a command or a stop would end with it."""
    visit = session_config(NetworkConfig(sockets=str(tmp_path)), ROBOT, "outside", visits=True)["id"]
    answers = [Hello(visit, ("tcp/10.0.0.2:7449",)), Hello("c0ffee", ("tcp/10.0.0.2:20001",))]
    scouted = SimpleNamespace(try_recv=lambda: answers.pop(0) if answers else None, stop=lambda: None)
    monkeypatch.setattr(zenoh, "scout", lambda *_, **__: scouted)
    monkeypatch.setattr(scouting, "_WITHIN", 0.05)
    assert find_doors() == ["tcp/10.0.0.2:20001"]
