"""docs/ros2.md has each topic of ROS with its type, its depth and its reliability, and no other."""

import re

from giraff_ros2.topics import ESTOP, NODE, PUBLISHED, SUBSCRIBED, Qos, RosTopic
from tests.rules.repository import ROOT


def qos_cell(qos: Qos) -> str:
    """Return a QoS as the page writes it."""
    return "LATCHED" if qos.is_latched else f"{'reliable' if qos.is_reliable else 'best effort'}, {qos.depth}"


def row_of(topic: RosTopic) -> tuple[str, str, str]:
    """Return what the page says of a topic: name, type and QoS."""
    return f"/{topic.name.replace('~', NODE)}", topic.type, "" if topic == ESTOP else qos_cell(topic.qos)


def test_the_page_has_the_table_of_topics() -> None:
    text = (ROOT / "docs" / "ros2.md").read_text(encoding="utf-8")
    shown = re.findall(
        r"^\| `(/\S+)`(?:, \w+)? \| `(\w+/(?:msg|srv)/\w+)` \|[^|]*\|[^|]*\| ?([^|]*?) ?\|", text, re.MULTILINE
    )
    assert shown == [row_of(topic) for topic in (*PUBLISHED, *SUBSCRIBED, ESTOP)]
