"""Hears localization, and shows what it says."""

from __future__ import annotations

import math
import time
from typing import Any, Final

from giraff_cli.localize.lines import PoseScreen
from giraff_cli.localize.view import PoseView
from giraff_core.latest import Latest
from giraff_maps.floor_plan import FloorPlan
from giraff_node import robot_now_ns
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Sample
from giraff_schemas.topics import POSE, Topic
from giraff_tools.network.connection import RobotConnection

_SHOW_EVERY: Final = 0.1  # s, while nothing is said


class Hearing:
    """Of one robot's, from now on."""

    def __init__(self, connection: RobotConnection, screen: PoseScreen, plan: FloorPlan | None = None) -> None:
        """`plan`: to be shown, where the screen is a terminal."""
        self._connection = connection
        self._screen, self._plan = screen, plan
        self._began = time.monotonic()
        self._heard_ns = 0
        self._has_news = False
        self._shown = -math.inf
        self.pose: MapPose | None = None
        """The newest."""
        connection.subscribe(POSE)

    def update(self) -> None:
        """Show what was said since the last call; else how old it is. Raises OSError where nobody sees it any more."""
        self._has_news = False
        self._connection.dispatch(self)
        if not self._has_news and time.monotonic() - self._shown >= _SHOW_EVERY:
            self._show()

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """Of the connection."""
        del topic, key
        if isinstance(sample, MapPose):
            self.pose, self._heard_ns, self._has_news = sample, at_ns, True
            self._show()

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """What it says counts here, not that it is there."""

    def _show(self) -> None:
        self._shown = time.monotonic()
        latest = None if self.pose is None else Latest(self.pose, (robot_now_ns() - self._heard_ns) * 1e-9)
        self._screen.show(PoseView(self._connection.robot, time.monotonic() - self._began, latest, self._plan))
