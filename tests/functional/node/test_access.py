"""Who may do what on a secured network: the rules, tried with real certificates on one loopback."""

import json
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zenoh

from giraff_node.network.discovery import RobotMonitor
from giraff_node.network.session import close_session, session_config
from giraff_schemas.topics import (
    CAMERA,
    CMD_VEL,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    ODOM,
    ODOM_RESET,
    ODOM_SET_POSE,
    PARAM_DESCRIBE,
    PARAM_SAVE,
    PARAM_SET,
    TICK,
    TILT,
    Topic,
    alive_key,
    frame_key,
    key_of,
)
from tests.functional.node.secured import MINE, Network, direct, open_marked
from tests.support.secured_hosts import HOSTS, ROBOT, authority
from tests.support.waiting import wait


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return authority(tmp_path_factory.mktemp("authority"))


@pytest.fixture(scope="module")
def network(keys: Path) -> Iterator[Network]:
    made = Network(keys)
    yield made
    made.close()


def keys_of(*topics: Topic[Any]) -> set[str]:
    return {topic.key for topic in topics}


def test_only_the_robots_own_hosts_reach_base(network: Network) -> None:
    assert keys_of(CMD_VEL, TICK, ODOM) <= network.heard_of("robot")


def test_an_operator_publishes_its_own_commands_and_nothing_else(network: Network) -> None:
    assert network.heard_of("laptop") == keys_of(MINE, TILT)


@pytest.mark.parametrize("host", ["desk", "unnamed"])
def test_nobody_else_commands(network: Network, host: str) -> None:
    assert network.heard_of(host) == set()


@pytest.mark.parametrize(("host", "hears"), [("robot", True), ("laptop", True), ("desk", True), ("unnamed", False)])
def test_whoever_is_named_reads(network: Network, host: str, hears: bool) -> None:
    with network.hearing(host, key_of(ROBOT, ODOM)) as heard:
        network.base.put(key_of(ROBOT, ODOM), "odometry")
    assert heard == (["odometry"] if hears else [])


@pytest.mark.parametrize(("host", "sees"), [("robot", True), ("laptop", True), ("desk", False), ("unnamed", False)])
def test_who_has_the_right_and_asks_sees_what_a_camera_sees(network: Network, host: str, sees: bool) -> None:
    """Nobody sees who merely listens to all that the robot says."""
    for key, expected in ((CAMERA.at("head").key, sees), ("**", False)):
        with network.hearing(host, f"giraff/{ROBOT}/{key}") as heard:
            network.base.put(key_of(ROBOT, CAMERA.at("head")), "picture")
        assert heard == (["picture"] if expected else []), key


@pytest.mark.parametrize(("host", "told"), [("robot", True), ("laptop", True), ("desk", True), ("unnamed", False)])
def test_whoever_is_named_is_told_where_the_frames_are(network: Network, host: str, told: bool) -> None:
    key = frame_key(ROBOT, "base_link")
    with network.base.declare_queryable(key, direct(_answer)):
        assert network.answers_of_base(host, frame_key(ROBOT)) == ([True] if told else [])


@pytest.mark.parametrize(
    ("host", "stops", "resets"),
    [("robot", True, True), ("laptop", True, True), ("desk", True, False), ("unnamed", False, False)],
)
def test_whoever_is_named_may_stop_and_operators_reset(network: Network, host: str, stops: bool, resets: bool) -> None:
    asked = ((ESTOP_ENGAGE, stops), (ESTOP_RESET, resets), (ODOM_RESET, resets), (ODOM_SET_POSE, resets))
    for query, answered in asked:
        assert network.answers_of_base(host, key_of(ROBOT, query)) == ([True] if answered else []), query.key


@pytest.mark.parametrize(
    ("host", "reads", "sets"),
    [("robot", True, True), ("laptop", True, True), ("desk", True, False), ("unnamed", False, False)],
)
def test_whoever_is_named_reads_parameters_and_operators_set_them(
    network: Network, host: str, reads: bool, sets: bool
) -> None:
    for query, answered in ((PARAM_DESCRIBE, reads), (PARAM_SET, sets), (PARAM_SAVE, sets)):
        found = network.answers_of_base(host, key_of(ROBOT, query.at("guard")))
        assert found == ([True] if answered else []), query.key
    everybodys = network.answers_of_base(host, key_of(ROBOT, PARAM_DESCRIBE))  # as `giraff doctor` asks
    assert everybodys == ([True] if reads else [])


def test_a_joystick_answers_for_its_parameters_and_for_no_other_service(network: Network) -> None:
    for service, answered in (("joystick", True), ("base", False)):
        key = key_of(ROBOT, PARAM_DESCRIBE.at(service))
        with network.sessions["laptop"].declare_queryable(key, direct(_answer)):
            assert network.answers_to_base("laptop", key) == ([True] if answered else [])


def _answer(query: zenoh.Query) -> None:
    with query:
        query.reply(query.key_expr, "mine")


@pytest.mark.parametrize(
    ("host", "service", "seen"),
    [("laptop", "joystick", True), ("laptop", "client", True), ("laptop", "base", False), ("desk", "base", False)],
)
def test_nobody_poses_as_a_service_of_the_robot(network: Network, host: str, service: str, seen: bool) -> None:
    with network.sessions[host].liveliness().declare_token(alive_key(ROBOT, service, "one")):
        network.base_has_all_of(host)
        replies = network.base.liveliness().get(alive_key(ROBOT, service), timeout=0.7)
        assert [reply.ok is not None for reply in replies] == ([True] if seen else [])


def test_the_robots_own_certificate_does_not_speak_for_its_host(network: Network) -> None:
    """Another host may have come by it; what base acts on comes by a socket."""
    away = open_marked(network.of["robot"], "outside")
    mark = key_of(ROBOT, ODOM)

    def is_heard() -> bool:
        for key in (*(key_of(ROBOT, topic) for topic in (TICK, CMD_VEL)), mark):
            away.put(key, "away")
        return ("odom", "away") in network.heard

    network.heard.clear()
    wait(is_heard, 60.0, every=0.1)
    close_session(away)
    assert {key for key, maker in network.heard if maker == "away"} == {"odom"}


def test_a_command_that_names_no_robot_finds_it_through_the_door(network: Network) -> None:
    """A stop of whatever robot is there asks for all of them."""
    with network.base.liveliness().declare_token(alive_key(ROBOT, "base", "one")):
        away = msgspec.structs.replace(network.of["desk"], sockets="/proc/nowhere")
        client = open_marked(away, "client")
        found = RobotMonitor(client)
        wait(lambda: found.all_names == [ROBOT], 60.0)
        close_session(client)


def test_a_stranger_gets_no_link(network: Network, keys: Path, tmp_path: Path) -> None:
    """Another authority's certificate, none at all, plain tcp: not even the greeting comes about."""
    before = links_of(network)
    another = msgspec.structs.replace(network.of["robot"], keys=str(authority(tmp_path) / "robot"))
    no_certificate = session_config(network.of["robot"], ROBOT, "outside")
    no_certificate["transport"]["link"]["tls"] = {"root_ca_certificate": str(keys / "ca.pem")}
    no_certificate["listen"]["endpoints"] = []
    plain = session_config(msgspec.structs.replace(network.of["robot"], mode="fixed"), ROBOT, "outside")
    callers = (session_config(another, ROBOT, "outside"), no_certificate, plain)
    heard: list[str] = []
    with ExitStack() as stack:
        strangers = [zenoh.open(zenoh.Config.from_json5(json.dumps(config))) for config in callers]
        for stranger in strangers:
            stack.callback(close_session, stranger)
            stack.enter_context(stranger.declare_subscriber("**", lambda sample: heard.append(str(sample.key_expr))))
        network.heard.clear()
        # They dial as often as anybody: once somebody who came after them is linked, they would be, too.
        later = open_marked(network.of["desk"], "outside")
        stack.callback(close_session, later)
        linked = sorted([*before, "desk"])

        def has_come() -> bool:
            network.base.put(key_of(ROBOT, ODOM), "secret")
            for stranger in strangers:
                stranger.put(key_of(ROBOT, CMD_VEL), "stranger")
            return links_of(network) == linked

        wait(has_come, 60.0, every=0.1)
        for host in HOSTS:
            network.base_has_all_of(host)
        links = [list(stranger.info.links()) for stranger in strangers]
        assert links_of(network) == linked
    assert links == [[], [], []]
    assert "stranger" not in {maker for _, maker in network.heard}
    assert not [key for key in heard if key.endswith(ODOM.key)]


def links_of(network: Network) -> list[str]:
    """Who has a link to base."""
    return sorted(link.auth_identifier or "" for link in network.base.info.links())
