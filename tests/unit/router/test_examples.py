"""What deploy/ has for a router's host is what the router takes."""

import os
from pathlib import Path

from giraff_node.config.robot_file import load, read_tables
from giraff_router.config import RouterConfig
from giraff_sim.board import ROOT

EXAMPLE = ROOT / "deploy" / "router" / "robot.toml"


def environment(**variables: str) -> dict[str, str]:
    return {"GIRAFF_CONFIG": str(EXAMPLE)} | variables


def test_the_robot_file_is_one() -> None:
    assert set(read_tables(environment())) == {"router"}
    router = load("router", RouterConfig, environment())
    assert router.mode == "secured"
    assert router.robots["giraff"].robot == ("robot",)


def test_a_variable_overrides_a_field() -> None:
    router = load("router", RouterConfig, environment(GIRAFF_ROUTER_SITES='["clinic", "ward", "away"]'))
    assert router.sites == ("clinic", "ward", "away")


def test_the_env_names_the_folder_of_the_robot_file() -> None:
    lines = (ROOT / "deploy" / "env" / "router.env").read_text().splitlines()
    given = dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))
    assert given["COMPOSE_PROFILES"] == "router"
    assert Path(os.path.normpath(ROOT / given["CONFIG_DIR"])) == EXAMPLE.parent
