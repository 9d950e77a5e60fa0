"""Who may do what on a secured network, by the rules that each node is given.

That Zenoh keeps to them, with real certificates: tests/functional/node/test_access.py.
"""

from pathlib import Path
from typing import Any

import msgspec
import pytest
import zenoh

from giraff_core.access import AccessConfig, access_control, with_inside
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import session_config
from giraff_schemas.services import SERVICES
from giraff_schemas.topics import (
    CAMERA_ON,
    CAMERA_PICTURES,
    CMD_VEL,
    DRIVING_QUERIES,
    ESTOP,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    LOCALIZATION_GLOBAL,
    LOCALIZATION_SET_POSE,
    MOTION_HOLD,
    ODOM_ECHOES,
    ODOM_RESET,
    ODOM_SET_POSE,
    OPERATOR_CMD_VEL,
    PARAM_SET,
    PLACES_HOLD,
    PLACES_SET,
    RANGE,
    TICK,
    TILT,
    TOPICS,
    WHEELS,
    Query,
    Topic,
    alive_key,
    health_key,
    key_of,
)
from tests.support.secured_hosts import ACCESS, HOSTS, ROBOT, authority

MINE, ANOTHERS = OPERATOR_CMD_VEL.at("joystick"), OPERATOR_CMD_VEL.at("keyboard")


def lets_in(host: str, message: str, key: str, access: AccessConfig = ACCESS, me: str = "") -> bool:
    """Whether a node takes of this host a message whose key expression is that, or any part of it."""
    return lets("ingress", host, message, key, access, me)


def lets(flow: str, host: str, message: str, key: str, access: AccessConfig = ACCESS, me: str = "") -> bool:
    """Whether a node takes it of this host, or gives it."""
    control = access_control(access, ROBOT, me)
    subjects = {subject["id"] for subject in control["subjects"] if host in subject.get("cert_common_names", ())}
    granted = {rule for policy in control["policies"] if subjects & {*policy["subjects"]} for rule in policy["rules"]}
    return any(
        zenoh.KeyExpr(allowed).intersects(zenoh.KeyExpr(key))
        for rule in control["rules"]
        if rule["id"] in granted and flow in rule["flows"] and message in rule["messages"]
        for allowed in rule["key_exprs"]
    )


def publishes(host: str) -> set[str]:
    """Topics that base takes of this host."""
    topics = (*(topic for topic in TOPICS if not topic.names), MINE, ANOTHERS)
    return {topic.key for topic in topics if lets_in(host, "put", key_of(ROBOT, topic))}


def test_the_robots_own_hosts_publish_everything() -> None:
    assert publishes("robot") == {topic.key for topic in TOPICS if not topic.names} | {MINE.key, ANOTHERS.key}


def test_an_operator_publishes_its_own_commands_and_nothing_else() -> None:
    assert publishes("laptop") == {MINE.key, TILT.key}


@pytest.mark.parametrize("host", ["desk", "unnamed"])
def test_nobody_else_commands(host: str) -> None:
    assert publishes(host) == set()


@pytest.mark.parametrize(
    ("host", "stops", "sets"),
    [("robot", True, True), ("laptop", True, True), ("desk", True, False), ("unnamed", False, False)],
)
def test_whoever_is_named_may_stop_and_operators_reset_and_set(host: str, stops: bool, sets: bool) -> None:
    for harmless in (ESTOP_ENGAGE, ODOM_ECHOES):
        assert lets_in(host, "query", key_of(ROBOT, harmless)) == stops, harmless.key
    to_localization = (LOCALIZATION_SET_POSE, LOCALIZATION_GLOBAL, PLACES_SET)
    asked = (ESTOP_RESET, ODOM_RESET, ODOM_SET_POSE, *to_localization, PARAM_SET.at("guard"))
    for query in asked:
        assert lets_in(host, "query", key_of(ROBOT, query)) == sets, query.key
    assert {other for other in HOSTS if lets_in(other, "query", f"giraff/{ROBOT}/**")} == {"robot", "laptop", "desk"}


MOVING = AccessConfig(
    robot=("robot",),
    operators={"laptop": ("joystick",), "desk": ("script", "motion")},
    viewers=("screen",),
    routers=("router",),
)


def moves(host: str, access: AccessConfig = MOVING) -> set[str]:
    """What the robot takes of this host that begins, goes on with or ends a motion, or moves the wheels by its name."""
    asked = {query.key for query in DRIVING_QUERIES if lets_in(host, "query", key_of(ROBOT, query), access)}
    said = (MOTION_HOLD, PLACES_HOLD, OPERATOR_CMD_VEL.at("motion"))
    return asked | {topic.key for topic in said if lets_in(host, "put", key_of(ROBOT, topic), access)}


ASKS_AND_HOLDS = {*(query.key for query in DRIVING_QUERIES), MOTION_HOLD.key, PLACES_HOLD.key}


def test_who_has_the_name_asks_for_motions_and_only_the_robot_drives_by_it() -> None:
    assert moves("desk") == ASKS_AND_HOLDS
    assert moves("robot") == {*ASKS_AND_HOLDS, OPERATOR_CMD_VEL.at("motion").key}


@pytest.mark.parametrize("host", ["laptop", "screen", "unnamed"])
def test_nobody_else_asks_for_a_motion_or_holds_one(host: str) -> None:
    assert moves(host) == set()


def test_a_router_passes_on_motions_where_some_operator_may_ask() -> None:
    assert moves("router") == ASKS_AND_HOLDS
    assert moves("router", msgspec.structs.replace(MOVING, operators={"laptop": ("joystick",)})) == set()


SEEING = AccessConfig(
    robot=("robot",),
    operators={"laptop": ("joystick",), "desk": ("web", "camera")},
    viewers=("screen",),
    routers=("router",),
)
NO_SEER = msgspec.structs.replace(SEEING, operators={"laptop": ("joystick",)})


@pytest.mark.parametrize(
    ("access", "asks", "sees"),
    [(SEEING, {"robot", "desk", "router"}, {"robot", "desk", "router"}), (NO_SEER, {"robot"}, {"robot"})],
)
def test_who_has_the_name_asks_for_a_cameras_picture_and_gets_it(
    access: AccessConfig, asks: set[str], sees: set[str]
) -> None:
    on = key_of(ROBOT, CAMERA_ON.at("head"))
    assert {host for host in (*access.hosts, "unnamed") if lets_in(host, "put", on, access)} == asks
    for topic in CAMERA_PICTURES:
        key = key_of(ROBOT, topic.at("head"))
        assert {host for host in access.hosts if lets("egress", host, "put", key, access)} == sees
        assert {host for host in access.hosts if lets_in(host, "put", key, access)} == {"robot"}


def test_who_may_see_does_not_drive_by_that_name() -> None:
    assert not lets_in("desk", "put", key_of(ROBOT, OPERATOR_CMD_VEL.at("camera")), SEEING)


WITH_PAGE = AccessConfig(robot=("robot",), operators={"hall": ("web",)}, viewers=("screen",))
"""A page is served by the host `hall`."""


def test_the_host_of_a_page_drives_stops_and_resets_by_its_name() -> None:
    def may(message: str, *topics: Topic[Any] | Query[Any, Any]) -> list[bool]:
        return [lets_in("hall", message, key_of(ROBOT, topic), WITH_PAGE) for topic in topics]

    assert may("put", OPERATOR_CMD_VEL.at("web")) == [True]
    assert may("query", ESTOP_ENGAGE, ESTOP_RESET) == [True, True]
    for message in ("liveliness_token", "declare_queryable", "reply"):
        assert [lets_in("hall", message, key(ROBOT, "web"), WITH_PAGE) for key in (alive_key, health_key)] == [True] * 2


def test_it_speaks_neither_as_the_robot_nor_as_another_operator() -> None:
    said = {topic.key for topic in TOPICS if lets_in("hall", "put", key_of(ROBOT, topic), WITH_PAGE)}
    assert said == {TILT.key, OPERATOR_CMD_VEL.key}, "of the latter its own name alone"
    others = [OPERATOR_CMD_VEL.at(name) for name in ("joystick", "keyboard", "motion")]
    assert [topic for topic in others if lets_in("hall", "put", key_of(ROBOT, topic), WITH_PAGE)] == []
    assert not lets_in("hall", "put", key_of(ROBOT, CMD_VEL), WITH_PAGE)
    robots = [service.name for service in SERVICES if service.host == "robot"]
    assert [name for name in robots if lets_in("hall", "liveliness_token", alive_key(ROBOT, name), WITH_PAGE)] == []
    assert [query for query in DRIVING_QUERIES if lets_in("hall", "query", key_of(ROBOT, query), WITH_PAGE)] == []


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return authority(tmp_path_factory.mktemp("authority"))


def test_links_speak_tls_only(keys: Path) -> None:
    config = session_config(
        NetworkConfig(mode="secured", connect=("192.0.2.1",), keys=str(keys / "laptop"), access=ACCESS), ROBOT, "door"
    )
    assert config["transport"]["link"]["protocols"] == ["tls"]
    assert config["transport"]["link"]["tls"]["enable_mtls"] is True
    assert config["scouting"]["multicast"]["enabled"] is False
    endpoints = config["listen"]["endpoints"] + config["connect"]["endpoints"]
    assert {endpoint.split("/")[0] for endpoint in endpoints} == {"tls"}
    assert "tls/192.0.2.1:7447" in endpoints


def test_no_rule_that_lets_in_covers_bases_door(keys: Path) -> None:
    """`cmd_vel/**` would match `cmd_vel`, too."""
    network = NetworkConfig(mode="secured", keys=str(keys / "laptop"), access=ACCESS, local=True)
    config = session_config(network, ROBOT, "inside")
    door = zenoh.KeyExpr(key_of(ROBOT, CMD_VEL))
    opened_by = [
        rule["id"]
        for rule in config["access_control"]["rules"]
        if rule["permission"] == "allow"
        and "ingress" in rule["flows"]
        and {"put", "delete"} & set(rule["messages"])
        and any(zenoh.KeyExpr(key).intersects(door) for key in rule["key_exprs"])
    ]
    assert opened_by == ["the robot tells", "does all"]


def test_missing_keys_are_named_with_the_way_out(tmp_path: Path) -> None:
    network = NetworkConfig(mode="secured", keys=str(tmp_path), access=ACCESS)
    with pytest.raises(ConfigError, match=r"ca\.pem: No such file or directory.*giraff keys host"):
        session_config(network, ROBOT, "door")


@pytest.mark.parametrize(
    ("access", "complaint"),
    [
        ({}, "names no host of the robot"),
        ({"robot": ["a"], "viewers": ["a"]}, "a: one host has one certificate"),
        ({"robot": ["a"], "operators": {"b": ["joy/stick"]}}, "cannot be part of a key"),
        ({"robot": ["a"], "operator": {}}, "unknown field `operator`"),
    ],
)
def test_rules_that_cannot_be_meant_are_refused(access: dict[str, Any], complaint: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=complaint):
        msgspec.convert({"mode": "secured", "access": access}, NetworkConfig)


@pytest.mark.parametrize("mode", ["lan", "fixed"])
def test_a_robot_on_several_hosts_needs_certificates(mode: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=r"anybody on the network could speak for guard and ranger"):
        msgspec.convert({"mode": mode, "access": {"robot": ["robot", "second"]}}, NetworkConfig)


@pytest.mark.parametrize("link", ["tcp", "tls"])
def test_who_is_inside_takes_what_base_and_guard_act_on_over_no_link_to_another_host(link: str) -> None:
    control = with_inside({}, is_split=False)
    assert control["default_permission"] == "deny"  # of a link that is of no known kind
    for topic in (TICK, WHEELS, CMD_VEL, RANGE.at("rear"), ESTOP):
        assert denies(control, "ingress", link, key_of(ROBOT, topic))


def test_a_robot_on_several_hosts_takes_it_from_its_certificates() -> None:
    assert not denies(with_inside({}, is_split=True), "ingress", "tls", key_of(ROBOT, CMD_VEL))


def test_the_robots_certificate_does_not_speak_for_its_host() -> None:
    """Of several subjects of a link one that may is enough, so the denial stands with what lets the robot in."""
    control = with_inside(access_control(ACCESS, ROBOT), is_split=False)
    assert {"rules": ["inside only"], "subjects": ["robot"]} in control["policies"]


def denies(control: dict[str, Any], flow: str, link: str, key: str) -> bool:
    """Whether a node refuses this key on links of a kind, whatever else it allows: Zenoh lets a denial win."""
    subjects = {subject["id"] for subject in control["subjects"] if link in subject.get("link_protocols", ())}
    bound = {rule for policy in control["policies"] if subjects & {*policy["subjects"]} for rule in policy["rules"]}
    return any(
        rule["permission"] == "deny" and flow in rule["flows"] and {"put", "delete"} <= {*rule["messages"]}
        for rule in control["rules"]
        if rule["id"] in bound and any(zenoh.KeyExpr(held).includes(zenoh.KeyExpr(key)) for held in rule["key_exprs"])
    )
