"""What a host believes of a router, and how it finds one. With real links: tests/functional/router/test_router.py."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_core.access import AccessConfig, access_control
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.key_bundle import BUNDLE_FILE
from giraff_node.network.session import session_config
from giraff_schemas.topics import CMD_VEL, OPERATOR_CMD_VEL, TILT, key_of
from giraff_setup.keys.manage import make_authority, make_bundle

ROBOT = "anne"
ACCESS = AccessConfig(
    robot=("robot",), operators={"laptop": ("joystick",), "doctor": ("doctor",)}, viewers=("desk",), routers=("router",)
)
OPERATORS_KEYS = {
    key_of(ROBOT, topic) for topic in (OPERATOR_CMD_VEL.at("joystick"), OPERATOR_CMD_VEL.at("doctor"), TILT)
}


def believed(control: dict[str, Any], host: str = "router") -> set[str]:
    """Key expressions of the samples that a node takes of `host`."""
    subjects = {subject["id"] for subject in control["subjects"] if host in subject.get("cert_common_names", ())}
    granted = {rule for policy in control["policies"] if subjects & {*policy["subjects"]} for rule in policy["rules"]}
    taken = [rule for rule in control["rules"] if rule["id"] in granted and "put" in rule["messages"]]
    return {key for rule in taken if "ingress" in rule["flows"] for key in rule["key_exprs"]}


@pytest.mark.parametrize("me", ["robot", "unnamed", ""])
def test_a_robot_takes_of_a_router_what_operators_may_say(me: str) -> None:
    assert believed(access_control(ACCESS, ROBOT, me)) == OPERATORS_KEYS
    assert key_of(ROBOT, CMD_VEL) not in OPERATORS_KEYS


@pytest.mark.parametrize("me", ["laptop", "desk"])
def test_those_who_move_no_motor_hear_the_robot_through_it(me: str) -> None:
    assert believed(access_control(ACCESS, ROBOT, me)) == {f"giraff/{ROBOT}/**"}


@pytest.mark.parametrize("me", ["robot", "laptop", "desk"])
def test_nobody_else_gains_by_a_router(me: str) -> None:
    alone = msgspec.structs.replace(ACCESS, routers=())
    for host in alone.hosts:
        assert believed(access_control(ACCESS, ROBOT, me), host) == believed(access_control(alone, ROBOT, me), host)


def network(keys: Path, **changes: Any) -> NetworkConfig:
    given = {"mode": "secured", "router": "router.example.org", "site": "home", "keys": str(keys)} | changes
    return msgspec.convert(given | {"access": msgspec.to_builtins(ACCESS)}, NetworkConfig)


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    made, now = tmp_path / "keys", datetime.now(UTC)
    make_authority(made, now)
    for host in ("robot", "desk"):
        make_bundle(made, host, ["192.0.2.1"], days=30, renew=False, moment=now)
    return made


def test_a_host_goes_by_the_name_in_its_bundle(keys: Path) -> None:
    taken = {
        host: believed(session_config(network(keys / host), ROBOT, "door")["access_control"])
        for host in ("robot", "desk")
    }
    assert taken == {"robot": OPERATORS_KEYS, "desk": {f"giraff/{ROBOT}/**"}}


def test_a_bundle_that_does_not_say_whose_it_is_is_refused_with_the_way_out(keys: Path) -> None:
    (keys / "robot" / BUNDLE_FILE).unlink()
    with pytest.raises(ConfigError, match=r"bundle\.toml.*No such file.*giraff keys host --renew"):
        session_config(network(keys / "robot"), ROBOT, "door")


def test_every_peer_of_a_site_dials_the_router_and_tells_its_site(keys: Path) -> None:
    config = session_config(network(keys / "robot"), ROBOT, "door")
    assert "tls/router.example.org:7447" in config["connect"]["endpoints"]
    assert config["region_name"] == "home"


def test_without_a_router_nothing_is_dialled_and_no_site_told() -> None:
    config = session_config(NetworkConfig(), ROBOT, "door")
    assert config["connect"]["endpoints"] == ["tcp/127.0.0.1:7447"]
    assert "region_name" not in config


def test_a_robot_kept_off_the_network_dials_no_router(keys: Path) -> None:
    assert "router" not in str(session_config(network(keys / "robot", local=True), ROBOT, "door")["connect"])


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"site": ""}, "router is given, but not at which site"),
        ({"site": "x" * 33}, "1 to 32 letters"),
        ({"router": "tls/router.example.org:7447"}, "router: 'tls/router.example.org:7447' is no address"),
    ],
)
def test_a_router_that_cannot_be_dialled_is_refused(tmp_path: Path, changes: dict[str, str], complaint: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=complaint):
        network(tmp_path, **changes)
