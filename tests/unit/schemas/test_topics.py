"""Keys are whole chunks of the table's rows."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_schemas.topics import (
    CMD_VEL,
    OPERATOR_CMD_VEL,
    RANGE,
    TICK,
    TOPICS,
    alive_key,
    health_key,
    key_of,
    require_chunk,
)

BAD_CHUNKS = ["a/b", "*", "**", "", "..", "ä", "a b", "a$b", "a?", "a#", "/", "a\n", "\0", "\x7f", " ", '"a"', "'a'"]


def test_a_key_is_root_robot_and_row() -> None:
    assert key_of("sim-lab", TICK) == "giraff/sim-lab/tick"
    assert key_of("giraff", CMD_VEL) == "giraff/giraff/cmd_vel"


def test_a_row_for_each_operator_or_sensor_is_a_key_expression_until_it_is_given_a_name() -> None:
    assert key_of("giraff", OPERATOR_CMD_VEL) == "giraff/giraff/cmd_vel/*"
    assert key_of("giraff", OPERATOR_CMD_VEL.at("keyboard")) == "giraff/giraff/cmd_vel/keyboard"
    rear = RANGE.at("rear")
    assert rear.key == "range/rear"
    assert (rear.schema, rear.rate_hz, rear.qos) == (RANGE.schema, RANGE.rate_hz, RANGE.qos)
    assert RANGE.key == "range/*"


@pytest.mark.parametrize("name", BAD_CHUNKS)
def test_a_name_that_is_not_one_chunk_is_refused(name: str) -> None:
    for use in (require_chunk, RANGE.at, lambda robot: key_of(robot, TICK)):
        with pytest.raises(ValueError, match="cannot be part of a key"):
            use(name)


@given(name=st.text(alphabet="abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_", min_size=1))
def test_letters_digits_dashes_and_underscores_are_one_chunk(name: str) -> None:
    assert require_chunk(name) == name
    assert key_of(name, RANGE.at(name)).split("/") == ["giraff", name, "range", name]


@given(name=st.text())
def test_whatever_is_accepted_stays_one_chunk(name: str) -> None:
    try:
        key = key_of("robot", RANGE.at(name))
    except ValueError:
        return
    assert len(key.split("/")) == 4
    assert not set("*$?# ") & set(key)
    assert key.isascii()


def test_keys_of_processes() -> None:
    assert alive_key("giraff", "base", "a1") == "giraff/giraff/alive/base/a1"
    assert alive_key("giraff") == "giraff/giraff/alive/*/*"
    assert health_key("giraff", "base") == "giraff/giraff/health/base"
    assert health_key("giraff") == "giraff/giraff/health/*"


def test_motion_and_what_it_is_judged_by_go_before_all_else() -> None:
    assert {topic.key for topic in TOPICS if topic.qos == "control"} == {
        "tick",
        "cmd_vel/*",
        "cmd_vel",
        "range/*",
        "bumper/*",
        "scan/*",
        "attitude",
        "wheels",
        "lease",
        "estop",
        "motion/hold",
        "places/hold",
    }
    assert all(topic.rate_hz >= 0.0 for topic in TOPICS)
