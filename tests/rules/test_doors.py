"""docs/freshness.md lists every door to motion, each with the rule that proves the age of what comes through it."""

import re
import tomllib
from typing import Final

import msgspec
from msgspec.structs import fields

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels import camera_doubt
from giraff_core.motion import timely
from giraff_core.motion.wish import OF_PLACES
from giraff_guard.config import GuardConfig
from giraff_keyboard.policy import KEY_LASTS
from giraff_motion import localized, policy
from giraff_ros2 import goal
from giraff_ros2.hand.publisher import OLD
from giraff_ros2.topics import ESTOP, SUBSCRIBED
from giraff_schemas.services import BASE, GUARD, MOTION, ROS2, SERVICES
from giraff_schemas.topics import OPERATOR_CMD_VEL
from giraff_web.hand import WISH_LASTS
from tests.rules.repository import ROOT


def default(config: type[msgspec.Struct], name: str) -> float:
    return float(next(field.default for field in fields(config) if field.name == name))


OPERATOR: Final = default(BaseConfig, "operator_budget")
MOST: Final = {
    "cmd_vel/*": default(GuardConfig, "operator_budget"),
    **dict.fromkeys(("motion/move", "motion/turn", "motion/arc", "motion/go", "places/go"), timely.WISH_COUNTS),
    **dict.fromkeys(("motion/hold", "places/hold"), policy._HOLD_COUNTS),
    "pose": localized._COUNTS,
    "visual_odom": camera_doubt._OLDEST,
    "estop/reset": default(BaseConfig, "reset_budget"),
    **dict.fromkeys(("joystick", "client", "motion"), OPERATOR),
    "keyboard": KEY_LASTS,
    "web": WISH_LASTS,
    "ros2 cmd_vel": OLD,
    "ros2 goal_pose": goal._BEGINS_WITHIN,
}
"""s. Oldest that may move the robot, by door. What only stops has none."""
STOPS: Final = "it stops"


def doors() -> set[str]:
    """Return what others may say to base, guard and motion and of routes, and every service that may ask to drive."""
    inside = {topic for service in SERVICES if service.inside for topic in service.publishes} - {OPERATOR_CMD_VEL}
    found = {query.key for service in (BASE, GUARD, MOTION) for query in service.answers}
    found |= {topic.key for service in (BASE, GUARD, MOTION) for topic in service.subscribes if topic not in inside}
    found |= {OF_PLACES.go.key, OF_PLACES.hold.key, OF_PLACES.cancel.key}
    found |= {each.name for each in SERVICES if OPERATOR_CMD_VEL in each.publishes and each is not ROS2}
    return found | {f"ros2 {topic.name}" for topic in (*SUBSCRIBED, ESTOP)}


def rows() -> dict[str, tuple[str, str]]:
    """Return the age and the rule of each door of the page's table."""
    page = (
        (ROOT / "docs" / "freshness.md").read_text(encoding="utf-8").partition("## Every door")[2].partition("\n## ")[0]
    )
    found: dict[str, tuple[str, str]] = {}
    for line in page.splitlines():
        if line.startswith("| ") and "`" in line:
            door, _, most, rule = (cell.strip() for cell in line.strip("|").split("|"))
            service, *names = re.findall("`([^`]+)`", door)
            names = [f"ros2 {name}" for name in names] if service == "ros2" else [service, *names]
            found |= dict.fromkeys(names, (most, rule))
    return found


def test_each_door_has_a_row_and_each_row_a_door() -> None:
    assert rows().keys() == doors()


def test_each_row_names_a_rule_that_is_broken_once_and_the_age_that_the_code_has() -> None:
    mutants = tomllib.loads((ROOT / "tests" / "mutants" / "mutants.toml").read_text(encoding="utf-8"))["mutant"]
    rules = {each["rule"] for each in mutants}
    assert {rule for _, rule in rows().values()} <= rules | {STOPS}
    told = {door: float(most) for door, (most, rule) in rows().items() if rule != STOPS}
    assert told == MOST
