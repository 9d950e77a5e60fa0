"""Recorded pictures through the policy of giraff_vision, beside what it said of them then. Pure."""

import math
from collections import deque
from collections.abc import Iterable
from typing import Final

from giraff_cli.replay.agreement import Agreement
from giraff_cli.replay.policies import RecordedSamples
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera
from giraff_schemas.camera import Picture, VisualOdometry
from giraff_schemas.messages import Odometry
from giraff_schemas.topics import VISUAL_ODOM
from giraff_vision.policy import VisionPolicy, grey_of

_NEAR: Final = 0.0005
"""m and rad by which a motion may differ. Which corners are tried first depends on all pictures since the start."""
_REMEMBERED: Final = 500
"""Samples of odometry: 5 s of it."""


def replay_vision(said: RecordedSamples, pictures: Iterable[Picture], robot: RobotConfig) -> Agreement:
    """Replay pictures and odom to visual_odom. `pictures`: in the order in which they were heard. Raises ValueError.

    No sample says what the policy remembered of the pictures before. So it begins at a key picture, and the comparison
    at the next one: until then motions guessed before are missed. It begins again behind a picture that is missing, or
    that only one of the two took for a key picture.
    """
    found, cameras = Agreement(service="vision", key=VISUAL_ODOM.key), robot.of(Camera)
    told = said.of(VisualOdometry)
    numbered = {(each.instance, each.seq): each for each in told}
    waiting = {(each.camera, each.picture, each.tick, each.width): each for each in told}
    odometry, recent = deque(said.of(Odometry)), deque[Odometry](maxlen=_REMEMBERED)
    life: _Life | None = None
    for picture in pictures:
        then = waiting.pop((picture.camera, picture.seq, picture.tick, picture.width), None)
        if then is None:
            continue
        new = []
        while odometry and odometry[0].stamp_ns <= then.stamp_ns:
            new.append(odometry.popleft())
        recent.extend(new)
        following = numbered.get((then.instance, then.seq + 1))
        differs = None
        if life is not None and life.next == (then.instance, then.seq):
            differs = life.differences(new, picture, then)
        elif then.seq == 0 or (then.is_measured and following is not None and following.key > then.key):
            camera = cameras.get(then.camera)
            life = None if camera is None else _Life(camera, recent, picture, then)
        if differs is None:
            found.left_out += 1
        else:
            found.add(then, differs)
    found.left_out += len(waiting)
    return found


class _Life:
    """One policy, from a key picture on that was a measurement: behind another one it may have had its doubts."""

    def __init__(self, camera: Camera, odometry: Iterable[Odometry], picture: Picture, then: VisualOdometry) -> None:
        self._camera, self._policy = camera, VisionPolicy(camera)
        self._keys: int | None = None
        """Key pictures before the first one of this life. None: not known yet."""
        self._first = self._say(odometry, picture)
        self._is_settled = then.seq == 0
        self.next: tuple[str, int] | None = (then.instance, then.seq + 1)
        """Instance and number of the sample to compare with next. None: both have other key pictures."""

    def differences(self, odometry: Iterable[Odometry], picture: Picture, then: VisualOdometry) -> list[str] | None:
        """Return how what it says now differs from `then`; None where nothing is to be compared."""
        now = self._say(odometry, picture)
        self._keys = then.key - now.key if self._keys is None else self._keys
        self._is_settled = self._is_settled or now.key > self._first.key
        if then.key != now.key + self._keys:
            self.next = None
            return [f"key {then.key} then, {now.key + self._keys} now"] if self._is_settled else None
        self.next = then.instance, then.seq + 1
        if not self._is_settled:
            return None
        found = [f"reason {str(then.reason)!r} then, {str(now.reason)!r} now"] if then.reason != now.reason else []
        for name in ("motion", "wheels"):
            before, after = getattr(then, name), getattr(now, name)
            is_near = before == after if None in {before, after} else math.dist(before, after) <= _NEAR
            found += [] if is_near else [f"{name} {before} then, {after} now"]
        return found

    def _say(self, odometry: Iterable[Odometry], picture: Picture) -> VisualOdometry:
        for each in odometry:
            self._policy.on_odometry(each)
        return self._policy.on_picture(picture, grey_of(picture.jpeg, self._camera))
