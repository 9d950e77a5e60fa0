"""Shows ROS what the robot's cameras see, as long as a ROS program subscribes, and no longer."""

from collections.abc import Callable
from typing import Final, Protocol

from giraff_core.robot import RobotConfig
from giraff_ros2.messages.sensors import picture
from giraff_ros2.port import RosPort
from giraff_ros2.topics import CAMERA
from giraff_schemas.camera import Picture

_APART: Final = 1.0  # s between two starts to look: each opens a session


class PictureSource(Protocol):
    """Sees a camera: `giraff_node.picture_client.PictureClient` in a process. No call waits."""

    def want(self) -> None: ...
    def pop_picture(self) -> Picture | None: ...
    def close(self) -> None: ...


OpenSource = Callable[[str, str], PictureSource]
"""Takes the camera's name, and who looks."""


class Cameras:
    """Every camera of the robot."""

    def __init__(self, robot: RobotConfig, ros: RosPort, open_source: OpenSource | None, by: str) -> None:
        """`by`: who looks, for people."""
        self._topics = {name: CAMERA.at(name) for name in robot.cameras} if open_source is not None else {}
        self._ros, self._open, self._by = ros, open_source, by
        self._sources: dict[str, PictureSource] = {}
        self._opened: dict[str, float] = {}

    def turn(self, now: float) -> None:
        """Look where somebody wants it. `now`: s, monotonic."""
        for name, topic in self._topics.items():
            if not self._ros.is_wanted(topic):
                self._leave(name)
            elif (source := self._source(name, now)) is not None:
                source.want()
                if (seen := source.pop_picture()) is not None:
                    self._ros.publish(topic, picture(seen))

    def close(self) -> None:
        """Look no longer."""
        for name in list(self._sources):
            self._leave(name)

    def _source(self, name: str, now: float) -> PictureSource | None:
        if name not in self._sources and self._open is not None and now - self._opened.get(name, -_APART) >= _APART:
            self._opened[name] = now
            self._sources[name] = self._open(name, self._by)
        return self._sources.get(name)

    def _leave(self, name: str) -> None:
        if (source := self._sources.pop(name, None)) is not None:
            source.close()
