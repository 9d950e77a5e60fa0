"""The camera is open while somebody looks, and shows him nothing that was taken before."""

from unittest.mock import MagicMock

import msgspec
import numpy as np

from giraff_camera.config import CameraConfig
from giraff_camera.device.image import Image
from giraff_camera.service import Camera
from giraff_core.senses import Camera as CameraModel
from giraff_schemas.camera import HOLD_ENDS, CameraHold
from giraff_schemas.topics import CAMERA, CAMERA_ON, CAMERA_SMALL, CAMERA_STATE
from giraff_schemas.trouble import NO_TROUBLE
from tests.support.robots import ROBOT

WITH_CAMERA = msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"head": CameraModel(x=0.0, z=1.0)})


class Desk:
    """The service, with a camera that is a mock."""

    def __init__(self) -> None:
        self.holds: list[CameraHold] = []
        self.put = {topic.key: MagicMock() for topic in (CAMERA.at("head"), CAMERA_SMALL.at("head"))}
        io = MagicMock(instance="camera")
        io.inbox = lambda topic: MagicMock(pop_all=self._take if topic.key == CAMERA_ON.at("head").key else list)
        io.publisher = lambda topic: MagicMock() if topic == CAMERA_STATE.at("head") else self.put[topic.key]
        self.capture = MagicMock(fault=NO_TROUBLE, rate=15.0, is_stuck=False)
        self.capture.pop_picture.return_value = None
        self.it = Camera(io, CameraConfig(), WITH_CAMERA, self.capture, lambda _: None)

    def _take(self) -> list[CameraHold]:
        taken, self.holds = self.holds, []
        return taken

    def look(self, state: int) -> None:
        self.holds.append(
            CameraHold(camera="head", to="camera", state=state, by="me", size="small", instance="me", seq=state)
        )

    @property
    def shown(self) -> int:
        return sum(each.put.call_count for each in self.put.values())


def test_the_camera_is_closed_once_nobody_looks_and_an_old_picture_is_shown_to_nobody() -> None:
    desk = Desk()
    desk.it.turn(10.0)
    assert not desk.capture.start.called
    desk.look(0)
    desk.capture.pop_picture.return_value = Image(np.zeros((240, 320), np.uint8), 10.0, None)
    desk.it.turn(10.1)
    desk.it.turn(10.11)  # another one, which waits for the word that the first has come
    desk.capture.pop_picture.return_value = None
    assert (desk.capture.start.called, desk.shown) == (True, 1)
    desk.capture.reset_mock()
    desk.capture.pop_picture.return_value = None
    desk.it.turn(10.1 + HOLD_ENDS)
    assert (desk.capture.start.called, desk.capture.stop.called) == (False, True)
    desk.look(1)
    desk.it.turn(10.3 + HOLD_ENDS)
    assert (desk.capture.start.called, desk.shown) == (True, 1)
