"""What the disk says of the emergency stop, beside what base was asked and has confirmed."""

from __future__ import annotations

from typing import Final

import msgspec

from giraff_node.estop import LATCH_FILE, EStopLatch
from giraff_schemas.messages import EStopAnswer
from giraff_sim.dst.stops import ROBOT_US
from giraff_sim.hosts.disk import Disk
from giraff_sim.hosts.process import Process

_WRITTEN_US: Final = 300_000  # within which a base that runs has an engaged stop on a disk that works


class LatchWatch:
    """Of the robot's disk."""

    def __init__(self, disk: Disk) -> None:
        self._disk = disk
        self._read = b""
        self._says_engaged = False
        self._engaged_us = 0  # since when the disk says so
        self._unsaved_us = 0

    def look(self, now_us: int) -> None:
        """After each step."""
        data = self._disk.files[LATCH_FILE]
        if data is not self._read:
            self._read = data
            before, self._says_engaged = self._says_engaged, msgspec.json.decode(data, type=EStopLatch).engaged
            if self._says_engaged and not before:
                self._engaged_us = now_us

    @property
    def says_engaged(self) -> bool:
        return self._says_engaged

    def power(self, now_us: int) -> str:
        """Why no motor may have power by what the disk says; empty where it may."""
        if self._says_engaged and now_us - self._engaged_us > ROBOT_US:
            return f"power {(now_us - self._engaged_us) / 1e6:.3f} s after the disk had the emergency stop"
        return ""

    def answered(self, answer: EStopAnswer, now_us: int) -> str:
        """What is wrong with an answer of base."""
        self.look(now_us)
        if answer.done and answer.engaged and not self._says_engaged:
            return f"latch {answer.id} is confirmed, and the disk says released"
        return ""

    def unsaved(self, base: Process, step_us: int) -> str:
        """Asked in each step of an engaged stop: that it comes onto the disk while `base` runs and the disk works."""
        if self._says_engaged or base.ended or base.stalled or not self._disk.works:
            self._unsaved_us = 0
            return ""
        self._unsaved_us += step_us
        if self._unsaved_us <= _WRITTEN_US:
            return ""
        return f"the emergency stop is not on disk after {self._unsaved_us / 1e6:.3f} s"
