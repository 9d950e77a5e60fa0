"""The cameras that ROS looks at, by calling."""

from giraff_ros2.cameras import Cameras
from giraff_ros2.topics import RosTopic
from giraff_schemas.camera import Picture
from giraff_schemas.messages import RobotTime
from tests.support.robots import FITTED


class Eye:
    """Sees a camera."""

    def __init__(self) -> None:
        self.wanted, self.closed = 0, False

    def want(self) -> None:
        self.wanted += 1

    def pop_picture(self) -> Picture | None:
        tick = RobotTime(epoch=1, robot_ns=1)
        return Picture(camera="head", jpeg=b"\xff", width=1, height=1, tick=tick, stamp_ns=1)

    def close(self) -> None:
        self.closed = True


class Watchers:
    """Who of ROS subscribes."""

    def __init__(self) -> None:
        self.there = False
        self.published: list[str] = []

    def is_wanted(self, topic: RosTopic) -> bool:
        return self.there and topic.name == "camera/head/compressed"

    def publish(self, topic: RosTopic, message: object) -> None:
        del message
        self.published.append(topic.name)


def test_a_camera_is_looked_at_only_while_somebody_of_ros_subscribes() -> None:
    watchers, eyes = Watchers(), list[tuple[str, Eye]]()

    def look(camera: str, by: str) -> Eye:
        eyes.append((f"{camera} by {by}", Eye()))
        return eyes[-1][1]

    cameras = Cameras(FITTED, watchers, look, "ros2@desk")  # type: ignore[arg-type]  # what it needs of it
    cameras.turn(0.0)
    assert not eyes
    watchers.there = True
    cameras.turn(0.1)
    cameras.turn(0.2)
    ((who, eye),) = eyes
    assert (who, eye.wanted) == ("head by ros2@desk", 2)
    assert watchers.published == ["camera/head/compressed"] * 2
    watchers.there = False
    cameras.turn(0.3)
    assert eye.closed
    watchers.there = True
    cameras.turn(0.4)  # too soon after the last start
    assert len(eyes) == 1
    cameras.turn(1.2)
    assert len(eyes) == 2
    cameras.close()
    assert eyes[1][1].closed
