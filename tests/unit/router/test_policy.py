"""Whom the router lets say what, and what it says of them. That Zenoh keeps to it: tests/functional/router."""

from typing import Any

import zenoh

from giraff_core.access import AccessConfig
from giraff_router.policy import Visitors, gateway, rules
from giraff_schemas.topics import CMD_VEL, OPERATOR_CMD_VEL, key_of

ANNE = AccessConfig(
    robot=("anne-pc",), operators={"doctor": ("doctor",)}, viewers=("desk",), routers=("router", "second")
)
BOB = AccessConfig(robot=("bob-pc",), operators={"doctor": ("doctor",)})
ROBOTS = {"anne": ANNE, "bob": BOB}


def may_put(host: str, key: str) -> bool:
    """What Zenoh makes of the rules, for a sample that comes in."""
    made = rules(ROBOTS)
    subjects = {subject["id"] for subject in made["subjects"] if host in subject["cert_common_names"]}
    granted = {rule for policy in made["policies"] if subjects & {*policy["subjects"]} for rule in policy["rules"]}
    return any(
        zenoh.KeyExpr(allowed).includes(zenoh.KeyExpr(key))
        for rule in made["rules"]
        if rule["id"] in granted and "ingress" in rule["flows"] and "put" in rule["messages"]
        for allowed in rule["key_exprs"]
    )


def test_each_site_is_a_region_of_its_own() -> None:
    assert gateway(("home", "away")) == {
        "south": [{"filters": [{"region_names": ["home"]}]}, {"filters": [{"region_names": ["away"]}]}]
    }


def test_a_robots_host_speaks_for_its_robot_alone() -> None:
    assert may_put("anne-pc", key_of("anne", CMD_VEL))
    assert not may_put("anne-pc", key_of("bob", CMD_VEL))
    assert not may_put("bob-pc", key_of("anne", OPERATOR_CMD_VEL.at("doctor")))


def test_an_operator_of_two_robots_asks_each_of_them() -> None:
    for robot in ROBOTS:
        assert may_put("doctor", key_of(robot, OPERATOR_CMD_VEL.at("doctor")))
        assert not may_put("doctor", key_of(robot, OPERATOR_CMD_VEL.at("joystick")))
        assert not may_put("doctor", key_of(robot, CMD_VEL))


def test_no_router_speaks_through_a_router() -> None:
    """The robot's hosts take operators' commands of it; another router, or a thief of its keys, is nobody here."""
    for router in ANNE.routers:
        assert not may_put(router, key_of("anne", OPERATOR_CMD_VEL.at("doctor")))
        assert router not in str(rules(ROBOTS))


def test_no_two_rules_have_one_name() -> None:
    made: dict[str, list[dict[str, Any]]] = rules(ROBOTS)
    for part in ("rules", "subjects"):
        names = [entry["id"] for entry in made[part]]
        assert len(names) == len(set(names))


def test_who_comes_and_goes_is_told_once_for_each_host() -> None:
    visitors = Visitors(ROBOTS)
    two = [("anne-pc", "tls/192.0.2.1:40001"), ("anne-pc", "tls/192.0.2.1:40002")]
    assert visitors.update(two) == ["anne-pc is here, from tls/192.0.2.1"]
    assert visitors.update(two[:1]) == []
    assert visitors.update([("anne-pc", "tls/192.0.2.7:40001")]) == ["anne-pc is here, from tls/192.0.2.7"]
    assert visitors.update([]) == ["anne-pc is gone"]


def test_a_host_without_a_part_is_named_while_it_is_there() -> None:
    visitors = Visitors(ROBOTS)
    visitors.update([("anne-pc", "tls/192.0.2.1:40001"), ("tablet", "tls/192.0.2.2:40001")])
    assert str(visitors.strangers).startswith("tablet: has a certificate, but no part")
    visitors.update([("anne-pc", "tls/192.0.2.1:40001")])
    assert not visitors.strangers


def test_without_certificates_nobody_is_a_stranger() -> None:
    visitors = Visitors({})
    assert visitors.update([("somebody", "tcp/192.168.1.7:40001")]) == ["somebody is here, from tcp/192.168.1.7"]
    assert not visitors.strangers
