"""Which robot a command is for: with a robot file, with none, with a broken one, and on a network of several."""

from functools import partial
from pathlib import Path
from typing import cast

import pytest
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network import discovery as robots
from giraff_node.network import tokens
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import RobotMonitor, find_robot, host_of, others, resolve_target
from giraff_schemas.codec import encode
from giraff_schemas.health import Health
from giraff_schemas.topics import alive_key, health_key
from tests.rules.repository import ROOT
from tests.support.one_process import Clock, Session

ONE, OTHER = "sim-one", "sim-other"


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A directory with no robot file."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def robot_file(directory: Path, text: str) -> dict[str, str]:
    path = directory / "robot.toml"
    path.write_text(text)
    return {"GIRAFF_CONFIG": str(path)}


def test_nothing_need_be_at_hand() -> None:
    way = resolve_target(None, (), {})
    assert (way.robot, way.network, way.warning) == ("", NetworkConfig(), "")
    way = resolve_target("otto", ["10.0.0.2:7447"], {"GIRAFF_NETWORK_RENDEZVOUS": "127.0.0.1:9"})
    assert way.robot == "otto"
    assert way.network == NetworkConfig(connect=("10.0.0.2:7447",), rendezvous="127.0.0.1:9")


def test_the_command_line_counts_before_the_environment_and_that_before_the_file(elsewhere: Path) -> None:
    environment = robot_file(elsewhere, '[robot]\nname = "filed"\n[network]\nconnect = ["a:1"]')
    assert resolve_target(None, ["b:2"], environment).robot == "filed"
    assert resolve_target(None, ["b:2"], environment).network.connect == ("a:1", "b:2")
    environment["GIRAFF_ROBOT_NAME"] = "named"
    assert resolve_target(None, (), environment).robot == "named"
    assert resolve_target("told", (), environment).robot == "told"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[robot", "not TOML"),
        ("[rowboat]", "unknown table"),
        ("[network]\nlocal = 'perhaps'", "local"),
    ],
)
def test_a_file_that_may_mean_another_robot_is_refused(elsewhere: Path, text: str, told: str) -> None:
    """Each command and the client: tests/unit/cli/test_refusal.py."""
    with pytest.raises(ConfigError, match=told):
        resolve_target("told", (), robot_file(elsewhere, text) | {"GIRAFF_ROBOT_NAME": "named"})


def test_what_is_wrong_elsewhere_is_told_and_stops_nobody_from_stopping_a_robot(elsewhere: Path) -> None:
    environment = robot_file(elsewhere, '[gaurd]\n[robot]\nname = "filed"\n[network]\nconnect = ["a:1"]')
    way = resolve_target(None, (), environment | {"GIRAFF_SPEED": "1"})
    assert (way.robot, way.network.connect) == ("filed", ("a:1",))
    assert "unknown table [gaurd]" in way.warning
    assert "GIRAFF_SPEED: names no field" in way.warning


def test_the_null_device_is_no_file_wherever_one_is(elsewhere: Path) -> None:
    """What a refused `giraff estop engage` names as the way out."""
    (elsewhere / "deploy").mkdir()
    (elsewhere / "deploy" / "robot.toml").write_text("[robot")
    with pytest.raises(ConfigError, match="not TOML"):
        resolve_target("told", (), {"GIRAFF_CONFIG": ""})
    way = resolve_target("told", (), {"GIRAFF_CONFIG": "/dev/null", "GIRAFF_NETWORK_CONNECT": '["a:1"]'})
    assert way.network == NetworkConfig(connect=("a:1",))


@pytest.mark.parametrize(
    ("before", "after", "filed"),
    [
        ("", "", ""),
        ("max_level = 70", "max_level = 80", ""),
        ('name = "giraff"', 'name = "anne"', "anne"),
        ("stall_level = 25", "stall_level = 25\nswap_motors = false", "giraff"),
        ("[network]", '[network]\nconnect = ["a:1"]', "giraff"),
    ],
)
def test_the_example_of_the_source_names_no_robot_until_somebody_makes_it_theirs(
    elsewhere: Path, before: str, after: str, filed: str
) -> None:
    """A stop then misses its robot: `giraff estop engage` tells that it was not heard."""
    (elsewhere / "deploy").mkdir()
    example = (ROOT / "deploy" / "robot.toml").read_text(encoding="utf-8")
    (elsewhere / "deploy" / "robot.toml").write_text(example.replace(before, after, 1), encoding="utf-8")
    way = resolve_target(None, (), {})
    assert (way.robot, way.filed, way.example) == ("", filed, "" if filed else "giraff")
    named = resolve_target(None, (), {"GIRAFF_CONFIG": "deploy/robot.toml"})
    assert named.robot == (filed or "giraff")


def test_a_file_that_leads_nowhere_is_not_passed_over(elsewhere: Path) -> None:
    (elsewhere / "deploy").mkdir()
    (elsewhere / "deploy" / "robot.toml").symlink_to("/nowhere/robot.toml")
    with pytest.raises(ConfigError, match="no robot file at"):
        resolve_target("told", (), {})


def test_a_name_that_can_be_none_is_refused() -> None:
    with pytest.raises(NoRobotError, match=r"robot: 'a/b' cannot be part of a key"):
        resolve_target("a/b", (), {})
    with pytest.raises(NoRobotError, match=r"--connect: 'a b' is no address"):
        resolve_target("anne", ["a b"], {})


@pytest.mark.parametrize(
    "key",
    [
        "giraff/a b/alive/base/x",
        "giraff/é/alive/base/x",
        "giraff/\x1b[2J/alive/base/x",
        "giraff/\u202egnik/alive/base/x",
        "giraff/\u200b/alive/base/x",
        "giraff/a\nb/alive/base/x",
        "giraff/*/alive/base/x",
        "giraff/a$*/alive/base/x",
        "giraff/otto/alive/b c/x",
        "giraff/otto/alive/base/\x9b1m",
        f"giraff/a/alive/b/{'a' * 81}",
        "giraff/**",
        "**",
    ],
)
def test_a_name_that_no_robot_can_have_is_left_out_and_told_once(
    network: "Network", monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], key: str
) -> None:
    """Anybody on an open network may declare it: the robots beside it are found all the same."""
    monkeypatch.setattr(tokens, "_told", set())
    assert tokens.read_token(key) is None
    assert ascii(key) in capsys.readouterr().err
    with network.others.declare_token(alive_key(ONE, "base", "1")), network.others.declare_token(key):
        assert tokens.list_robots(network.ours) == [ONE]
        assert RobotMonitor(network.ours).all_names == [ONE]
    assert capsys.readouterr().err == ""
    for number in range(20):
        tokens.read_token(f"giraff/{number} /alive/base/{'x' * 1000}")
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 4, "a stranger fills no log"
    assert max(map(len, told)) < 250


class Network:
    """Somebody looks, and others are there."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.others = Session(self.clock)
        self.ours = cast(zenoh.Session, self.others)


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    made = Network()
    monkeypatch.setattr(robots, "time", made.clock)
    return made


def test_the_only_robot_is_meant_where_nobody_names_one(network: Network) -> None:
    with pytest.raises(NoRobotError, match=r"no robot is heard on the network after 0\.3 s; check that it is on"):
        find_robot(network.ours, "", 0.3)
    with pytest.raises(NoRobotError, match="after 10 s"):  # which have gone by before anybody was given up
        find_robot(network.ours, "", 10.0, at_door=False)
    assert network.clock.monotonic() < 2.0
    comes = network.others.declare_token(alive_key(ONE, "guard", "1"))
    network.clock.after(3.0, comes.__enter__)
    assert find_robot(network.ours, "", 10.0) == ONE
    assert others(network.ours, ONE) == ""
    assert others(network.ours, "giraff") == f"; on the network: --robot {ONE}"
    comes.__exit__(None, None, None)


@pytest.mark.parametrize(("at_door", "moment"), [(True, 0.05), (False, 0.3)])
def test_of_several_one_must_be_named(network: Network, at_door: bool, moment: float) -> None:
    """Also where one of them is met a moment after the other."""
    tokens = network.others
    later = tokens.declare_token(alive_key(OTHER, "base", "2"))
    network.clock.after(moment, later.__enter__)
    with tokens.declare_token(alive_key(ONE, "base", "1")):
        names = ", ".join(f"--robot {name}" for name in sorted((ONE, OTHER)))
        with pytest.raises(NoRobotError, match=f"several robots are on the network; name one: {names}"):
            find_robot(network.ours, "", 10.0, at_door=at_door)
    later.__exit__(None, None, None)


@pytest.mark.parametrize("order", [("base", "ranger", "joystick"), ("joystick", "base", "ranger")])
def test_the_host_of_a_robot_is_its_base_s_whoever_answers_last(order: tuple[str, ...]) -> None:
    session = Session(Clock())

    def answer(service: str, _: bytes) -> tuple[float, bytes]:
        host = "desk-of-ann" if service == "joystick" else f"{service}-s"
        health = Health(service=service, instance="i", host=host, pid=1, uptime=1.0, ok=True, faults=())
        return order.index(service) * 0.01, encode(health)

    for service in order:
        session.answer(health_key(ONE, service), partial(answer, service))
    assert host_of(cast(zenoh.Session, session), ONE) == "base-s"
