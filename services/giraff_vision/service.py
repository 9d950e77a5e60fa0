"""Vision: pictures and `odom` to `visual_odom`. Not in the chain that drives: losing it changes no motion.

It is one who looks at the camera, as long as its process runs: who starts it wants that. The camera says so to all.
"""

import math
from typing import Final

import cv2

from giraff_core.io import IO, Inbox
from giraff_core.kinematics.pose import Pose
from giraff_core.picture.asker import PictureAsker
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_schemas.camera import HOLD_ENDS, CameraHold, Picture, PictureSize, VisualOdometry
from giraff_schemas.topics import CAMERA, CAMERA_ON, CAMERA_SMALL, CAMERA_STATE, ODOM, VISUAL_ODOM
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_vision import reasons
from giraff_vision.config import VisionConfig
from giraff_vision.ground import PictureError
from giraff_vision.policy import VisionPolicy, disagrees, grey_of, is_large

SETTLED: Final = 1.0
"""s without a disagreement after which it is over."""
_LOOK_HZ: Final = 2.0
"""Hz of a look at what is silent."""
SILENCE: Final = 1.0
"""s without a sample that is worth a word."""
_LATE_ODOM: Final = Trouble(
    "pictures are compared with no odom: it comes later than they do, or they have no tick of this base",
    "check that this host is not too busy, and that giraff_camera hears base: nothing else tells of a dirty lens",
)
_NO_ODOM: Final = Trouble("no odom is heard", "check that giraff_odometry runs: nothing else tells of a dirty lens")


class Vision:
    """Reads `camera/<name>/…` and `odom`; writes `visual_odom`."""

    link = None

    def __init__(self, io: IO, config: VisionConfig, robot: RobotConfig) -> None:
        """Raises ValueError where the robot file has no such camera."""
        cv2.setNumThreads(1)  # what drives the robot gets the other cores
        self._io = io
        self.camera, self._model = robot.camera(config.camera, "[vision] camera")
        self._policy = VisionPolicy(self._model)
        self._by = f"visual odometry ({io.hostname})"
        self._asker = PictureAsker(self.camera, self._by)
        self._odometry = io.inbox(ODOM, wakes=False)
        self._states = io.inbox(CAMERA_STATE.at(self.camera))
        self._pictures: dict[PictureSize, Inbox[Picture]] = {
            "full": io.inbox(CAMERA.at(self.camera), 4),
            "small": io.inbox(CAMERA_SMALL.at(self.camera), 4),
        }
        self._holds, self._out = io.publisher(CAMERA_ON.at(self.camera)), io.publisher(VISUAL_ODOM)
        self._timer = Timer(_LOOK_HZ)
        self.timers = (self._timer,)
        self._turned = -math.inf
        self._heard = self._disagreed = self._pictured = self._compared = io.monotonic()
        self._notice = NO_TROUBLE

    def turn(self, now: float) -> None:
        if now - self._turned > HOLD_ENDS:  # the machine slept: that wish is over
            self._ask(now)
        self._turned = now
        self._asker.want("full", now)
        for odometry in self._odometry.pop_all():
            self._heard = now
            self._policy.on_odometry(odometry)
        for state in self._states.pop_all():
            if self._asker.state is not None and self._asker.state.instance != state.instance:
                self._ask(now)  # the camera has started again
            self._say(self._asker.on_state(state, self._io.instance, now))
        for size, inbox in self._pictures.items():
            for picture in inbox.pop_all():
                if self._asker.takes(picture, size):
                    self._say(self._asker.on_picture(picture, size, now))
                    self._on_picture(picture, now)
        if self._asker.size != self._asker.listens:
            self._asker.listen(self._asker.size)
        if self._timer.due(now):
            self._report(now)

    def end(self) -> None:
        """Nothing is left to say: it looks no longer once its words are missing."""

    def _ask(self, now: float) -> None:
        self._asker = PictureAsker(self.camera, self._by)
        self._asker.want("full", now)

    def _say(self, hold: CameraHold | None) -> None:
        if hold is not None:
            self._holds.put(hold)

    def _on_picture(self, picture: Picture, now: float) -> None:
        try:
            told = self._policy.on_picture(picture, grey_of(picture.jpeg, self._model))
        except PictureError as error:
            self._io.set_fault("pictures", error.trouble)
            return
        self._io.set_fault("pictures", NO_TROUBLE)
        self._out.put(told)
        if told.wheels is not None:
            self._compared = now
        self._pictured = now
        if disagrees(told):
            self._disagreed = now
            self._notice = self._notice or _disagreement(told)

    def _report(self, now: float) -> None:
        self._io.set_notice("camera", self._asker.trouble(now))
        if now - self._disagreed > SETTLED:
            self._notice = NO_TROUBLE
        self._io.set_notice("wheels", self._notice)
        is_alone = self._pictured - self._compared > SILENCE
        self._io.set_notice("odom", _NO_ODOM if now - self._heard > SILENCE else _LATE_ODOM if is_alone else NO_TROUBLE)


def _disagreement(told: VisualOdometry) -> Trouble:
    """Return what people are told of a disagreement; NO_TROUBLE: it is small."""
    if told.motion is None or told.wheels is None:
        return NO_TROUBLE
    seen, wheels = Pose(*told.motion), Pose(*told.wheels)
    return reasons.disagreement(seen, wheels) if is_large(seen.seen_from(wheels)) else NO_TROUBLE
