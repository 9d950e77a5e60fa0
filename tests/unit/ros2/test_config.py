"""The table `[ros2]` and the options of `giraff ros2`: what cannot be is refused, and the option comes first."""

from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_cli.ros2.serve import config_of, print_lines
from giraff_ros2.config import Ros2Config
from giraff_ros2.main import shell_lines
from giraff_ros2.rmw.session import RosSession


@pytest.mark.parametrize("namespace", ["", "r1", "lab/r1", "_1/R_2"])
def test_names_of_ros_are_namespaces(namespace: str) -> None:
    assert Ros2Config(namespace=namespace).namespace == namespace


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"namespace": "/r1"}, "namespace is '/r1': write names of ROS, like r1 or lab/r1, without a slash first"),
        *(
            ({"namespace": each}, "write names of ROS")
            for each in ("1r", "r1/", "a//b", "r-1", "a b", "ä", "r1\n", "*")
        ),
        ({"domain": 233}, "domain"),
        ({"domain": -1}, "domain"),
        ({"distribution": "foxy"}, "distribution"),
        ({"router": "127.0.0.1:0"}, "router"),
        ({"router": "udp/localhost:7447"}, "router"),
        ({"operator": "a/b"}, "'a/b' cannot be part of a key"),
    ],
)
def test_what_cannot_be_is_refused_by_its_name(given: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        msgspec.convert(given, Ros2Config)


def test_an_option_comes_before_the_robot_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("GIRAFF_CONFIG", str(tmp_path / "robot.toml"))
    (tmp_path / "robot.toml").write_text('[ros2]\nnamespace = "r1"\ndomain = 7\n')
    assert config_of({}) == Ros2Config(namespace="r1", domain=7)
    assert config_of({"namespace": ""}) == Ros2Config(domain=7)
    with pytest.raises(ValueError, match="namespace is 'r-1'"):
        config_of({"namespace": "r-1"})


def test_a_shell_takes_all_that_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    print_lines(["export ROS_DOMAIN_ID=7"])
    first, line = capsys.readouterr().out.splitlines()
    assert (first[0], line) == ("#", "export ROS_DOMAIN_ID=7")


@pytest.mark.parametrize(
    ("host", "port", "line"),
    [
        ("127.0.0.1", 7447, ""),
        ("127.0.0.1", 7460, 'connect/endpoints=["tcp/127.0.0.1:7460"]'),
        ("::1", 7447, 'connect/endpoints=["tcp/[::1]:7447"]'),
        ("192.168.1.5", 7447, 'mode="client";connect/endpoints=["tcp/192.168.1.5:7447"]'),
    ],
)
def test_a_shell_of_ros_is_told_where_the_router_is(host: str, port: int, line: str) -> None:
    way = RosSession(MagicMock(), port, is_router=True, host=host)
    lines = shell_lines(Ros2Config(domain=3), way)
    assert lines[:2] == ["export RMW_IMPLEMENTATION=rmw_zenoh_cpp", "export ROS_DOMAIN_ID=3"]
    assert lines[2:] == ([f"export ZENOH_CONFIG_OVERRIDE='{line}'"] if line else [])
