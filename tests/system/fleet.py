"""Two robots at two sites, and those who drive and watch them from a third: sessions, with a router between them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from giraff_schemas.topics import (
    ESTOP_ENGAGE,
    ESTOP_RESET,
    ODOM,
    OPERATOR_CMD_VEL,
    TICK,
    TOPICS,
    Topic,
    alive_key,
    key_of,
)
from tests.system.behind_router import BehindRouter, Host, wait
from tests.system.sites import ROUTER, Sites

HOME, CLINIC, AWAY = "home", "clinic", "away"
ANNE, BOB = "sim-anne", "sim-bob"
"""Two robots; one at home, one at the clinic. The laptop drives anne, the doctor both, from away."""
ACCESS: dict[str, dict[str, Any]] = {
    ANNE: {
        "robot": ["anne-pc"],
        "operators": {"laptop": ["joystick"], "doctor": ["doctor"]},
        "viewers": ["desk"],
        "routers": [ROUTER],
    },
    BOB: {"robot": ["bob-pc"], "operators": {"doctor": ["doctor"]}, "routers": [ROUTER]},
}
PLACES = {
    "anne-pc": (HOME, ANNE),
    "bob-pc": (CLINIC, BOB),
    "laptop": (AWAY, ANNE),
    "doctor": (AWAY, ANNE),
    "desk": (AWAY, ANNE),
    "unnamed": (AWAY, ANNE),
}
JOYSTICK, DOCTOR = OPERATOR_CMD_VEL.at("joystick"), OPERATOR_CMD_VEL.at("doctor")
EVERY = (*(topic for topic in TOPICS if not topic.names), JOYSTICK, DOCTOR)
SEVERAL = ("giraff/{}/cmd_vel/*", "giraff/{}/*", "giraff/{}/**", "giraff/*/cmd_vel", "giraff/*/cmd_vel/joystick", "**")


NO_RULES = {"access_control": {"enabled": False}}
"""A host that does not keep to the rules itself: those of the others must do."""


class Fleet:
    def __init__(self, behind: BehindRouter, sites: Sites) -> None:
        self.behind = behind
        self.sites = sites
        behind.start_router()
        for host, (site, _) in PLACES.items():
            behind.certify(host, behind.address(site))
        self.of = {host: behind.join(host, site, robot) for host, (site, robot) in PLACES.items()}
        self.lawless = {host: behind.join(host, site, robot, **NO_RULES) for host, (site, robot) in PLACES.items()}
        for host, robot in (("anne-pc", ANNE), ("bob-pc", BOB)):
            for session in (self.of[host], self.lawless[host]):
                session.ask("subscribe", *(key_of(other, topic) for other in (ANNE, BOB) for topic in TOPICS))
            self.of[host].ask("answer", key_of(robot, ESTOP_ENGAGE), key_of(robot, ESTOP_RESET))
            self.of[host].ask("be", alive_key(robot, "base", "one"))
        self.of["laptop"].ask("be", alive_key(ANNE, "joystick", "one"))
        self.lawless["laptop"].ask("be", alive_key(ANNE, "guard", "one"))
        for host in ("laptop", "desk", "unnamed"):
            for session in (self.of[host], self.lawless[host]):
                session.ask("subscribe", *(key_of(robot, topic) for robot in (ANNE, BOB) for topic in (ODOM, TICK)))
        self.all_meet()

    def all_meet(self) -> float:
        """s until both ends of anne's way hear each other."""
        robot, laptop = self.of["anne-pc"], self.of["laptop"]

        def met() -> bool:
            robot.ask("put", "meeting", key_of(ANNE, TICK))
            laptop.ask("put", "meeting", key_of(ANNE, JOYSTICK))
            return met_by(robot, JOYSTICK) and met_by(laptop, TICK)

        heard: set[Host] = set()

        def met_by(host: Host, topic: Topic[Any]) -> bool:
            if [key_of(ANNE, topic), "meeting"] in host.ask("heard"):
                heard.add(host)
            return host in heard

        return wait(met)

    def say_everything(self, host: Host, text: str) -> dict[str, set[str]]:
        """Keys that each robot's host hears of what `host` says on each key of both robots, and on several at once."""
        robots = {robot: (self.of[f"{robot}-pc"], self.lawless[f"{robot}-pc"]) for robot in ("anne", "bob")}
        for sessions in robots.values():
            for session in sessions:
                session.ask("heard")
        host.ask("put", text, *(key_of(robot, topic) for robot in (ANNE, BOB) for topic in EVERY))
        host.ask("put", text, *(several.format(robot) for several in SEVERAL for robot in (ANNE, BOB)))
        time.sleep(0.5)  # nothing coming has no event to wait for
        return {
            robot: {
                key.removeprefix("giraff/")
                for session in sessions
                if session is not host
                for key, said in session.ask("heard")
                if said == text
            }
            for robot, sessions in robots.items()
        }


@contextmanager
def fleet(directory: Path) -> Iterator[Fleet]:
    with Sites(HOME, CLINIC, AWAY) as sites:
        behind = BehindRouter(directory, sites, (HOME, CLINIC, AWAY), ACCESS)
        try:
            yield Fleet(behind, sites)
        finally:
            behind.close()
