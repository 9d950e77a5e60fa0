"""`giraff localize --map`: finds the robot, asks where its sensors are, and is giraff_localization in this terminal."""

import math
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

from giraff_cli.localize.client import DONE, REFUSED, told_pose
from giraff_cli.localize.floor import floor_of
from giraff_cli.localize.view import Hearing, screen_of
from giraff_core.io import Selectable
from giraff_core.kinematics.pose import Pose
from giraff_core.retry import RetriedRequest
from giraff_core.timer import Timer
from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_localization.service import Localization
from giraff_maps.floor_plan import MapError
from giraff_maps.read import read_map
from giraff_node import Node
from giraff_node.config.settings import Settings
from giraff_schemas.localization import LocalizationAnswer
from giraff_schemas.services import LOCALIZATION
from giraff_schemas.topics import LOCALIZATION_SET_POSE
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_limits
from giraff_tools.network.localization import require_none
from giraff_tools.terminal.output import discard_stdout


def serve(
    robot: str | None,
    connect: Sequence[str],
    path: Path,
    place: Pose | None,
    seconds: float | None,
    *,
    as_json: bool,
) -> int:
    """Until Ctrl-C, or for `seconds`; the exit code. `place`: where the robot is; None: anywhere."""
    try:
        plan = read_map(path)
    except MapError as error:
        return print_error(str(error))

    def act(connection: RobotConnection) -> int:
        require_none(connection, "without --map this command shows and asks it; end it to start another")
        limits = ask_limits(connection, "localize")
        config = LocalizationConfig(map=str(path.absolute()))
        try:
            floor = floor_of(path, plan, config, limits)
        except MapError as error:
            return print_error(str(error))
        settings = Settings(config, limits, connection.network)
        # The services' runtime from here on, with its signals: whatever ends it, whoever hears it is told first.
        with (
            Node(LOCALIZATION.name, settings, session=connection.session) as node,
            closing(screen_of(as_json=as_json)) as screen,
        ):
            shown = ShownLocalization(node, floor, Hearing(connection, screen, plan), place, seconds)
            node.run(shown)
        return DONE if not shown.refused else print_error(shown.refused) and REFUSED

    return run_with_robot(robot, connect, act, moves=True)


class ShownLocalization:
    """The service, and what it says beside it in this terminal."""

    def __init__(
        self,
        node: Node[LocalizationConfig],
        floor: Floor,
        hearing: Hearing,
        place: Pose | None,
        seconds: float | None,
    ) -> None:
        self._node = node
        self._service = Localization(node, node.config, node.robot, floor)
        self._hearing = hearing
        self._place = place
        self._asking: RetriedRequest[LocalizationAnswer] | None = None
        self._until = node.monotonic() + (math.inf if seconds is None else seconds)
        self.refused = ""
        """Why the robot cannot be where it was said to be."""

    @property
    def timers(self) -> Sequence[Timer]:
        return self._service.timers

    @property
    def link(self) -> Selectable | None:
        return self._service.link

    def turn(self, now: float) -> None:
        self._service.turn(now)
        self._tell_place(now)
        try:
            self._hearing.update()
        except OSError:  # nobody sees any more what it says
            discard_stdout()
            self._node.leave()
        if now >= self._until:
            self._node.leave()

    def end(self) -> None:
        self._service.end()

    def _tell_place(self, now: float) -> None:
        """Once the map is read and odometry is heard: a place is of a moment."""
        pose = self._hearing.pose
        is_ready = pose is not None and pose.state != "no_map" and pose.tick is not None
        if self._asking is None and self._place is not None and is_ready:
            self._asking = self._node.ask(LOCALIZATION_SET_POSE, told_pose(self._place), lambda _: True)
        if self._asking is None or (answer := self._asking.poll(now)) is None:
            return
        self._asking = self._place = None
        if not answer.done:
            self.refused = f"--at: {answer.reason}"
            self._node.leave()
