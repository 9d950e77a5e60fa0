"""Which topic somebody means, and what nobody may say in a robot's name."""

from typing import Any

import pytest

from giraff_cli.topic.listing import QOS, rows_of
from giraff_cli.topic.publish import NotASampleError, parse_sample
from giraff_cli.topic.rates import rates_of
from giraff_schemas.messages import Battery, DriveCommand
from giraff_schemas.topics import (
    BATTERY,
    CMD_VEL,
    MOTION_HOLD,
    OPERATOR_CMD_VEL,
    PLACES_HOLD,
    RANGE,
    SERIAL,
    SERIAL_WRITE,
    TILT,
    TOPICS,
    TRUE_POSE,
    Topic,
)
from giraff_tools.network.connection import read_undeclared
from giraff_tools.network.robot_graph import RobotGraph
from giraff_tools.network.statistics import Arrival
from giraff_tools.network.topic_keys import UnknownKeyError, find_topic, intersects, publish_refusal

STRANGE = '{"state": "clear", "range": null, "echo_us": 0, "tick": {"epoch": 1, "robot_ns": 1, "s": 1}}'
SERVICES = {"base": ["tick", "wheels"], "guard": ["cmd_vel"], "joystick": ["tilt", "cmd_vel/joystick"]}


@pytest.mark.parametrize(
    ("key", "topic"),
    [
        ("odom", "odom"),
        ("range/*", "range/*"),
        ("range/rear", "range/rear"),
        ("cmd_vel", "cmd_vel"),
        ("cmd_vel/anna", "cmd_vel/anna"),
    ],
)
def test_a_key_is_found(key: str, topic: str) -> None:
    assert find_topic(key).key == topic


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("odmo", "there is no key 'odmo'; did you mean odom? there are: tick, tilt,"),
        ("xyz", "there is no key 'xyz'; there are: tick, tilt,"),
        ("range", "did you mean range/*"),
        ("range/a/b", "there is no key 'range/a/b'"),
        ("range/", "there is no key 'range/'"),
        ("", "there is no key ''"),
        ("giraff/otto/odom", "leave out giraff/<robot>/"),
        *((key, "asked, not published") for key in ("estop/engage", "param/guard", "param/guard/margin/x")),
        *((key, "asked, not published") for key in ("alive/base/1", "health/base", "frame/base_link")),
        ("**", "there is no key"),
    ],
)
def test_an_unknown_key_is_told_with_what_is_near(key: str, said: str) -> None:
    with pytest.raises(UnknownKeyError) as raised:
        find_topic(key)
    assert said in str(raised.value)


@pytest.mark.parametrize(
    ("payload", "encoding", "form", "content"),
    [
        (b'{"angle": 1.5}', "zenoh/bytes", "JSON", {"angle": 1.5}),
        (b"5", "application/json", "JSON", 5),
        (b"\x81\xa5angle\x05", "zenoh/bytes", "MessagePack", {"angle": 5}),
        (b"5", "application/msgpack", "MessagePack", 0x35),
        (b"5", "zenoh/bytes", "bytes", {"bytes": 1, "start": "5"}),
        (b"\xc1\x1b[2J", "application/json", "bytes", {"bytes": 5, "start": "c1 1b 5b 32 4a"}),
        (b"[" * 100_000, "", "bytes", {"bytes": 100_000, "start": "[" * 16}),
        (b"", "", "bytes", {"bytes": 0, "start": ""}),
    ],
)
def test_a_payload_of_a_makers_key_is_shown_as_what_it_is(
    payload: bytes, encoding: str, form: str, content: Any
) -> None:
    found = read_undeclared(payload, encoding)
    assert (found.form, found.content) == (form, content)


def test_a_makers_key_is_counted_as_it_comes() -> None:
    graph = RobotGraph("otto")
    for number in range(11):
        graph.count(Arrival("maker/arm", 20, None, number * 0.1, 0))
    [rate], [row] = rates_of(graph).rates, rows_of(graph, with_absent=False)
    assert (rate.key, rate.heard, rate.lost, rate.maker.name) == ("maker/arm", 11, 0, "?")
    assert rate.hz == row.hz == pytest.approx(10.0)
    assert rates_of(graph).well
    assert len(rows_of(graph, with_absent=True)) == 1 + len(TOPICS)


def test_what_covers_what() -> None:
    assert intersects("range/*", "range/rear")
    assert intersects("range/rear", "range/*")
    assert not intersects("cmd_vel", "cmd_vel/anna")
    assert not intersects("odom", "base")


OTHERS = (TILT, SERIAL, SERIAL_WRITE, TRUE_POSE)


@pytest.mark.parametrize("topic", [topic for topic in TOPICS if topic not in OTHERS], ids=lambda topic: topic.key)
def test_nothing_of_a_live_robots_own_is_said_for_it(topic: Topic[Any]) -> None:
    """By whichever of its services there is."""
    topic = topic.at("x") if "*" in topic.key else topic
    assert publish_refusal(topic, SERVICES)
    assert publish_refusal(topic, {"base": []})
    assert publish_refusal(topic, {"odometry": []})
    assert publish_refusal(topic, {}) == ""
    assert publish_refusal(topic, {"play": [topic.key]}) == ""
    assert publish_refusal(topic, {"play": [], "base": []})


@pytest.mark.parametrize("topic", [CMD_VEL, OPERATOR_CMD_VEL.at("anna"), MOTION_HOLD, PLACES_HOLD])
def test_whoever_wants_to_drive_is_shown_how(topic: Topic[Any]) -> None:
    assert "giraff_client" in publish_refusal(topic, SERVICES)


def test_what_is_no_robots_own_is_refused_while_somebody_says_it() -> None:
    assert "is said by joystick" in publish_refusal(TILT, SERVICES)
    assert publish_refusal(TILT, {"base": ["tick"]}) == ""
    assert "is said by run" in publish_refusal(TRUE_POSE, {"base": ["tick"], "run": ["true_pose"]})
    assert "is said by gateway" in publish_refusal(SERIAL.at("lamp"), {"base": ["tick"], "gateway": ["serial/lamp"]})
    assert publish_refusal(SERIAL_WRITE.at("lamp"), {"base": ["tick"], "gateway": ["serial/lamp"]}) == ""


def test_a_sample_is_typed_as_its_fields() -> None:
    assert parse_sample(BATTERY, '{"voltage": 24}') == Battery(voltage=24.0)
    text = '{"lease_counter": 0, "linear_x": 0, "angular_z": 0, "source": "hand", "tick": null}'
    command = parse_sample(OPERATOR_CMD_VEL.at("anna"), text)
    assert isinstance(command, DriveCommand)
    assert command.operator == "anna"


@pytest.mark.parametrize(
    ("topic", "text", "said"),
    [
        (BATTERY, "", "not JSON"),
        (BATTERY, "voltage: 24", "not JSON"),
        (BATTERY, "24", "a Battery is a JSON object"),
        (BATTERY, "{}", "`voltage` is missing"),
        (BATTERY, '{"voltage": "24"}', "voltage must be a number, and is text"),
        (BATTERY, '{"voltage": 24, "volts": 3}', "a Battery has no volts; it has"),
        (BATTERY, '{"voltage": 24, "seq": 3}', "seq: filled in"),
        (BATTERY, '{"voltage": NaN}', "not JSON"),
        (BATTERY, '{"voltage": 1e999}', "1e999 is beyond 64 bits"),
        (BATTERY, "[" * 100_000, "not JSON"),
        (
            RANGE.at("rear"),
            '{"sensor": "left", "state": "clear", "range": null, "echo_us": 0, "tick": null}',
            "sensor is 'left', and the key says otherwise",
        ),
        (
            RANGE.at("rear"),
            STRANGE,
            "a Range has no tick.s",
        ),
    ],
)
def test_what_is_no_sample_is_told(topic: Topic[Any], text: str, said: str) -> None:
    with pytest.raises(NotASampleError) as raised:
        parse_sample(topic, text)
    assert said in str(raised.value)


def test_each_topic_has_a_text_of_its_quality_of_service() -> None:
    assert all(QOS[topic.qos] for topic in TOPICS)
