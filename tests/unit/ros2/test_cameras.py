"""The cameras that ROS looks at, by calling."""

from unittest.mock import MagicMock

from giraff_ros2 import topics as ros
from giraff_ros2.robot_in_ros import RobotInRos
from giraff_schemas.camera import Picture
from giraff_schemas.messages import RobotTime
from tests.support.picture_source import Source, Sources
from tests.support.robots import FITTED


class Eye(Source):
    """A camera that has a new picture whenever it is asked."""

    def next_picture(self) -> Picture:
        tick = RobotTime(epoch=1, robot_ns=1)
        return Picture(camera="head", jpeg=b"\xff", width=1, height=1, tick=tick, stamp_ns=1)


def test_a_camera_is_looked_at_only_while_somebody_of_ros_subscribes() -> None:
    eyes, port, topic = Sources(Eye), MagicMock(), ros.CAMERA.at("head")
    port.wall_ns.return_value = 0
    it = RobotInRos(FITTED, port, eyes, "ros2@desk")
    came = []
    for now, is_watched in ((0.0, False), (0.1, True), (0.2, True), (0.3, False), (0.4, True), (1.2, True)):
        port.reset_mock()
        port.is_wanted = lambda asked, is_watched=is_watched: is_watched and asked == topic
        it.turn(now)
        came.append(topic in [call.args[0] for call in port.publish.call_args_list])
    assert came == [False, True, True, False, False, True], "too soon after the last start it looks not yet"
    assert [(eye.camera, eye.by, len(eye.asked), eye.closed) for eye in eyes.opened] == [
        ("head", "ros2@desk", 2, True),
        ("head", "ros2@desk", 1, False),
    ]
    it.close()
    assert eyes.opened[1].closed
