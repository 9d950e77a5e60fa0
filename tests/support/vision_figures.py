"""Visual odometry on filmed drives, compared with the truth."""

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from typing import Final

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Camera
from giraff_sim.camera.scene import Lens, Scene, Shadow, Walker
from giraff_sim.camera.textures import Floor
from giraff_vision.policy import VisionPolicy
from tests.support.filmed_drive import CAMERA, Filmed

TEXTURED: Final[tuple[Floor, ...]] = ("planks", "carpet", "brick")
_SHARE: Final = 0.2  # of a step between two pictures, beyond which it is wrong
_LEAST: Final = 0.001  # m
_TURN: Final = math.radians(0.6)
_PAIR: Final = 2  # pictures from one to the next that the independent check compares
_BEGIN, _END, _HALF = 1.0, 2.2, 0.8
"""m in `base_link`: part of the floor that its top view shows."""
_PIXEL: Final = 0.005  # m, of the top view

Answer = tuple[int, Pose | None, str]
"""Number of the key picture, motion since it, and why that is no measurement."""
Odometer = Callable[[Filmed], Answer]


def with_wheels(camera: Camera) -> Odometer:
    """Return the policy, which also hears the wheels."""
    return _of_policy(camera, hears_wheels=True)


def without_wheels(camera: Camera) -> Odometer:
    """Return the policy, of pictures alone."""
    return _of_policy(camera, hears_wheels=False)


def _of_policy(camera: Camera, *, hears_wheels: bool) -> Odometer:
    policy = VisionPolicy(camera)

    def look(shot: Filmed) -> Answer:
        for odometry in shot.odometry if hears_wheels else ():
            policy.on_odometry(odometry)
        told = policy.on_picture(shot.picture, shot.grey)
        return told.key, None if told.motion is None else Pose(*told.motion), str(told.reason)

    return look


class Tally:
    """Compares an odometer with the truth. The wheels fill its gaps."""

    def __init__(self, odometer: Odometer) -> None:
        self._odometer, self._key = odometer, -1
        self._last: Filmed | None = None
        self._pose = self._before = Pose(0.0, 0.0, 0.0)
        self._true = self._length = 0.0  # m
        self._took = list[float]()  # ms of the processor
        self.counts = Counter[str]()

    def take(self, shot: Filmed) -> None:
        """Show it the next picture."""
        began = time.process_time()
        key, motion, reason = self._odometer(shot)
        self._took.append(1e3 * (time.process_time() - began))
        last, self._last = self._last, shot
        if last is None:
            self._key, self._pose = key, shot.pose
            return
        if key != self._key:
            self._key, self._before = key, Pose(0.0, 0.0, 0.0)
        true, rolled = shot.pose.seen_from(last.pose), shot.wheels.seen_from(last.wheels)
        step = None if motion is None else motion.seen_from(self._before)
        self._before = motion or self._before
        filled = rolled if reason or step is None else step
        self._pose = filled.placed_in(self._pose)
        self._true += math.hypot(true.x, true.y)
        self._length += math.hypot(filled.x, filled.y)
        if max(abs(true.x), abs(rolled.x)) < 5 * _LEAST and not shot.is_turning:
            return  # it stands, or is about to
        is_wrong = step is None or _is_off(step, true)
        facts = {
            "frames": True,
            "measured": not reason,
            "turning": shot.is_turning,
            "measured turning": shot.is_turning and not reason,
            "wrong": is_wrong,
            "silent": is_wrong and not reason,
            "good but flagged": bool(reason) and not is_wrong,
        }
        self.counts.update(fact for fact, holds in facts.items() if holds)

    def figures(self) -> dict[str, float]:
        """Return % of the way, degrees, the length as a share of the true one, ms of a picture, and counts."""
        assert self._last is not None
        end = self._pose.seen_from(self._last.pose)
        return {
            "error": 100.0 * math.hypot(end.x, end.y) / self._true,
            "degrees": math.degrees(end.yaw),
            "length": self._length / self._true,
            "ms": float(np.median(self._took)),
            **self.counts,
        }


def _is_off(step: Pose, true: Pose) -> bool:
    off = math.dist(step[:2], true[:2]) > max(_SHARE * math.hypot(*true[:2]), _LEAST)
    return off or abs(step.yaw - true.yaw) > _TURN


def follow(odometers: Mapping[str, Odometer], filmed: Iterable[Filmed]) -> dict[str, Tally]:
    """Show one drive to some odometers."""
    tallies = {name: Tally(odometer) for name, odometer in odometers.items()}
    for shot, tally in itertools.product(filmed, tallies.values()):
        tally.take(shot)
    return tallies


def calibrated() -> dict[str, Camera]:
    """Return the camera as `giraff calibrate camera` may find it at its worst, by the signs of its errors."""
    return {
        f"calibrated {up:+} {down:+} {lens:+}": msgspec.structs.replace(
            CAMERA,
            z=CAMERA.z * (1.0 + up * 0.0063),
            pitch=CAMERA.pitch + down * math.radians(0.26),
            focal_x=CAMERA.focal_x * (1.0 + lens * 0.005),
            focal_y=CAMERA.focal_y * (1.0 + lens * 0.005),
        )
        for up, down, lens in ((1, -1, 1), (-1, 1, -1), (1, 1, 1), (-1, -1, -1))
    }


_PEOPLE: Final = {
    "crosses": tuple(Walker((x, side), (x, -side), 0.9) for x, side in ((1.8, 1.0), (3.0, -1.3), (4.2, 1.2))),
    "goes ahead": (Walker((1.5, 0.0), (9.0, 0.6), 0.38),),
}
_SHADOWS: Final = {"sways": Shadow(period=6.0), "goes along": Shadow(0.0, 1.7, 4.5, 60.0, 0.35)}
_LENSES: Final = {"grains and print": Lens(specks=100, print=0.12), "print": Lens(print=0.25)}
_POOR: Final[tuple[Floor, ...]] = ("carpet", "lino", "bare")
BAD: Final[dict[str, Scene]] = {
    "clear, carpet": Scene("carpet"),
    "clear, lino": Scene("lino"),
    "featureless": Scene("bare"),
    "dark": Scene("carpet", light=0.04),
    "over-exposed": Scene("carpet", light=3.0),
    "lamps switch": Scene("carpet", switching=1.0),
    "covered by 60 %": Scene("carpet", lens=Lens(covered=0.6)),
    "covered": Scene("carpet", lens=Lens(covered=1.0)),
    **{f"shadow {how}, {on}": Scene(on, shadow=shadow) for how, shadow in _SHADOWS.items() for on in _POOR},
    **{f"person {how}, {on}": Scene(on, people=people) for how, people in _PEOPLE.items() for on in _POOR},
    **{f"{what} on the lens, {on}": Scene(on, lens=lens) for what, lens in _LENSES.items() for on in _POOR},
}


def top_view_length(filmed: Iterable[Filmed]) -> float:
    """Return the m of a way by OpenCV alone: a similarity between top views of two pictures."""
    camera, shape = CAMERA, (int(2 * _HALF / _PIXEL) + 1, int((_END - _BEGIN) / _PIXEL) + 1)
    floor = np.array([[far, aside, 0.0] for far in (_BEGIN, _END) for aside in (_HALF, -_HALF)])
    lens = np.array([[camera.focal_x, 0.0, (camera.width - 1) / 2], [0.0, camera.focal_y, (camera.height - 1) / 2]])
    lens = np.vstack([lens, [0.0, 0.0, 1.0]])
    turned = cv2.Rodrigues(np.array([camera.pitch, 0.0, 0.0]))[0] @ np.array([[0, -1, 0], [0, 0, -1], [1.0, 0, 0]])
    seen, _ = cv2.projectPoints(floor, turned, -turned @ [camera.x, camera.y, camera.z], lens, np.zeros(5))
    above = np.array([[x, y] for y in (shape[1] - 1, 0) for x in (0, shape[0] - 1)], np.float32)
    homography = cv2.getPerspectiveTransform(seen.reshape(4, 2).astype(np.float32), above)
    past: NDArray[np.uint8] | None = None
    length = 0.0
    for shot in itertools.islice(filmed, 0, None, _PAIR):
        grey = cv2.undistort(shot.grey, lens, np.array(camera.distortion)).astype(np.float32)
        grey -= cv2.GaussianBlur(grey, (0, 0), 10.0) - 128.0  # the lens is darker at its rim
        warped = np.asarray(cv2.warpPerspective(grey, homography, shape, flags=cv2.INTER_CUBIC))
        view = np.clip(warped, 1, 255).astype(np.uint8)
        length += 0.0 if past is None else _between(past, view)
        past = view
    return length


def _between(past: NDArray[np.uint8], view: NDArray[np.uint8]) -> float:
    """Return the m from one top view to the next."""
    inside = np.zeros_like(past)
    inside[8:-8, 8:-8] = 255
    points = cv2.goodFeaturesToTrack(past, 200, 0.01, 8, mask=inside)
    found, status, _ = cv2.calcOpticalFlowPyrLK(past, view, points, points.copy(), winSize=(21, 21))
    before, after = points[status == 1], found[status == 1]
    matrix, kept = cv2.estimateAffinePartial2D(before, after, ransacReprojThreshold=1.0)
    before, after = before[kept[:, 0] == 1].astype(float), after[kept[:, 0] == 1].astype(float)
    angle = math.atan2(matrix[1, 0], matrix[0, 0])
    robot = np.array([_HALF / _PIXEL, _END / _PIXEL])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return float(np.hypot(*(after.mean(axis=0) - robot - turn @ (before.mean(axis=0) - robot)))) * _PIXEL
