"""The service looks at the camera as long as it runs, and tells what it cannot tell."""

from typing import Any, Final
from unittest.mock import MagicMock

import cv2
import msgspec
import numpy as np
import pytest

from giraff_core.senses import Camera
from giraff_schemas.camera import Asker, CameraHold, CameraState, Picture, Step, VisualOdometry
from giraff_schemas.topics import CAMERA, CAMERA_ON, CAMERA_SMALL, CAMERA_STATE, ODOM, VISUAL_ODOM
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_vision import reasons
from giraff_vision.config import VisionConfig
from giraff_vision.service import SILENCE, Vision
from tests.support.robots import ROBOT

_ME: Final = "vision"
FULL, SMALL, STATE = (each.at("head") for each in (CAMERA, CAMERA_SMALL, CAMERA_STATE))
ROBOT_SEES: Final = msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"head": Camera(z=1.0, pitch=0.5)})


class Desk:
    """The service, with topics that are lists."""

    def __init__(self) -> None:
        self.come: dict[str, list[Any]] = {each.key: [] for each in (ODOM, FULL, SMALL, STATE)}
        self.holds: list[CameraHold] = []
        self.told: list[VisualOdometry] = []
        self.troubles: dict[str, Trouble] = {}
        io = MagicMock(instance=_ME, hostname="robot")
        io.monotonic.return_value = 0.0
        io.inbox = lambda topic, *_, **__: MagicMock(pop_all=lambda: self._take(topic.key))
        kept: dict[str, list[Any]] = {CAMERA_ON.at("head").key: self.holds, VISUAL_ODOM.key: self.told}
        io.publisher = lambda topic: MagicMock(put=kept[topic.key].append)
        io.set_fault = io.set_notice = self.troubles.__setitem__
        self.it = Vision(io, VisionConfig(), ROBOT_SEES)
        self.now = 0.0

    def _take(self, key: str) -> list[Any]:
        taken, self.come[key] = self.come[key], []
        return taken

    def turn(self, seconds: float = 0.2) -> None:
        self.now += seconds
        self.it.turn(self.now)

    def state(self, instance: str, *askers: Asker, seq: int = 0) -> None:
        self.come[STATE.key].append(
            CameraState(
                camera="head",
                askers=askers,
                width=320,
                height=240,
                rate=15.0,
                instance=instance,
                seq=seq,
            )
        )

    def picture(self, instance: str, jpeg: bytes, *, small: bool = False) -> None:
        width, height = (160, 120) if small else (320, 240)
        picture = Picture(camera="head", jpeg=jpeg, width=width, height=height, tick=None, instance=instance)
        self.come[(SMALL if small else FULL).key].append(picture)


def _jpeg(height: int, width: int) -> bytes:
    grey = np.random.default_rng(0).integers(0, 255, (height, width), np.uint8)
    return cv2.imencode(".jpg", grey)[1].tobytes()


def test_it_looks_at_each_start_of_the_camera_and_says_who_it_is() -> None:
    desk = Desk()
    for instance in ("first", "second"):
        desk.state(instance)
        desk.turn()
        assert (desk.holds[-1].to, desk.holds[-1].by) == (instance, "visual odometry (robot)")
        desk.picture(instance, _jpeg(120, 160), small=True)
        desk.turn()
        assert (desk.holds[-1].seen, desk.told[-1].width) == (0, 160)
        desk.state(instance, Asker(instance=_ME, by="", size="full"), seq=1)
        desk.turn()
        desk.picture(instance, _jpeg(240, 320))
        desk.turn()
        assert (desk.holds[-1].size, desk.told[-1].width) == ("full", 320)
    desk.picture("first", _jpeg(240, 320))  # somebody else's, and late
    desk.turn()
    assert len(desk.told) == 4


def test_it_looks_again_after_its_machine_slept() -> None:
    desk = Desk()
    desk.state("camera")
    desk.turn()
    desk.turn(60.0)
    said = len(desk.holds)
    desk.state("camera", seq=1)
    desk.turn()
    assert len(desk.holds) == said + 1


@pytest.mark.parametrize(
    ("jpeg", "what"), [(b"\xff\xd8torn", "no JPEG"), (b"", "no JPEG"), (_jpeg(200, 320), "320 by 200")]
)
def test_a_picture_that_cannot_be_used_is_told_and_the_next_one_counts(jpeg: bytes, what: str) -> None:
    desk = Desk()
    desk.state("camera")
    desk.turn()
    desk.picture("camera", jpeg, small=True)
    desk.turn()
    assert what in str(desk.troubles["pictures"])
    assert not desk.told
    desk.picture("camera", _jpeg(120, 160), small=True)
    desk.turn()
    assert (desk.troubles["pictures"], len(desk.told)) == (NO_TROUBLE, 1)


def test_what_is_silent_is_told() -> None:
    desk = Desk()
    for _ in range(20):
        desk.turn()
    assert desk.now > SILENCE
    assert "no odom is heard" in str(desk.troubles["odom"])
    assert "is not heard" in str(desk.troubles["camera"])


def test_both_values_of_a_disagreement_are_told_and_neither_is_called_wrong() -> None:
    def told(motion: Step, wheels: Step) -> str:
        desk = Desk()
        desk.it._policy = MagicMock()
        desk.it._policy.on_picture.return_value = VisualOdometry(
            camera="head",
            picture=1,
            tick=None,
            key=1,
            reason=reasons.DISAGREE,
            motion=motion,
            wheels=wheels,
            path=(0.0, 0.0, 0.0),
        )
        desk.state("camera")
        desk.turn()
        desk.picture("camera", _jpeg(120, 160), small=True)
        desk.turn()
        desk.turn(0.5)
        return str(desk.troubles["wheels"])

    assert "the picture saw x 0.02 m, y 0.00 m, 0°, the wheels x 0.15 m, y 0.00 m, 0°; one" in told(
        (0.02, 0.0, 0.0), (0.15, 0.0, 0.0)
    )
    assert "saw x 0.00 m, y 0.00 m, 0°, the wheels x 0.00 m, y 0.00 m, 9°; one" in told(
        (0.0, 0.0, -0.001), (0.0, 0.0, 0.157)
    )
    assert told((0.0, 0.0, 0.0), (0.01, 0.0, 0.0)) == ""
