"""What the disk says of the emergency stop, beside what base was asked and has confirmed."""

from typing import Final

import msgspec

from giraff_core.estop.latch import LATCH_FILE, EStopLatch
from giraff_schemas.requests import EStopAnswer
from giraff_sim.dst.judging.stops import ROBOT_US
from giraff_sim.hosts.disk import Disk
from giraff_sim.hosts.process import Process
from giraff_sim.world.body import Body

_WRITTEN_US: Final = 300_000  # within which a base that runs has an engaged stop on a disk that works


class LatchWatch:
    """Of the robot's disk."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._read = b""
        self._says_engaged = False
        self._engaged_us = 0  # since when the disk says so
        self._unsaved_us = 0
        self.asked_us = -1
        """When base was asked to stop last, be it again by the same: a reset that was made before means another."""
        self._permitted_us: int | None = None  # when a reset came that may still release the disk

    def asked(self, now_us: int) -> None:
        """Base is asked to stop."""
        self.asked_us = now_us

    def permit(self, now_us: int) -> None:
        """Base is asked for a reset that a human has made: the disk may say released, once."""
        self._permitted_us = now_us

    def judge(self, disk: Disk, now_us: int) -> str:
        """After each step: why the disk may not say what it has come to say; empty where it may."""
        data = disk.files[LATCH_FILE]
        if data is self._read:
            return ""
        self._read = data
        before, self._says_engaged = self._says_engaged, msgspec.json.decode(data, type=EStopLatch).engaged
        permitted_us = self._permitted_us
        if self._says_engaged:
            if not before:
                self._engaged_us = now_us
            if permitted_us is not None and permitted_us < self.asked_us:
                self._permitted_us = None  # base has given that reset up for the newer engaging
            return ""
        self._permitted_us = None
        is_lost = before and permitted_us is None
        return "the disk has come to say released, and nobody has reset the emergency stop" if is_lost else ""

    @property
    def says_engaged(self) -> bool:
        return self._says_engaged

    def power(self, now_us: int) -> str:
        """Why no motor may have power by what the disk says; empty where it may."""
        if self._says_engaged and now_us - self._engaged_us > ROBOT_US + self._body.settles_us:
            return f"{self._body.acts} {(now_us - self._engaged_us) / 1e6:.3f} s after the disk had the emergency stop"
        return ""

    def answered(self, base: Process, answer: EStopAnswer, now_us: int) -> str:
        """What is wrong with an answer of `base`."""
        wrong = self.judge(base.host.disk, now_us)
        if answer.done and answer.engaged and not self._says_engaged:
            return f"latch {answer.id} is confirmed, and the disk says released"
        return wrong

    def unsaved(self, base: Process, step_us: int) -> str:
        """Asked in each step of an engaged stop: that it comes onto the disk while `base` runs and the disk works."""
        if self._says_engaged or base.ended or base.stalled or not base.host.disk.works:
            self._unsaved_us = 0
            return ""
        self._unsaved_us += step_us
        if self._unsaved_us <= _WRITTEN_US:
            return ""
        return f"the emergency stop is not on disk after {self._unsaved_us / 1e6:.3f} s"
