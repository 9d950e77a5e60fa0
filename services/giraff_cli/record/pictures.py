"""The pictures that `giraff record --camera` keeps. They are asked for, and come over a link of their own."""

import time
from typing import Final

from giraff_mcap.raw_sample import RawSample
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.topics import CAMERA_STATE, key_of
from giraff_tools.network.command import print_error
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.picture_subscriber import PictureSubscriber
from giraff_tools.terminal.signals import StopSignal

_TURN: Final = 0.015  # s; the quickest camera takes 60 pictures a second


class NoPictures:
    """None are asked for."""

    def wait(self, stopping: StopSignal, seconds: float) -> bool:
        """Wait for so long; True: somebody has asked for the end."""
        return stopping.wait(seconds)

    def pop_all(self) -> list[RawSample]:
        """Return what has come since the last call."""
        return []

    def close(self) -> None:
        """Ask for nothing more."""


class RecordedPictures(NoPictures):
    """All that the cameras of the robot see."""

    def __init__(self, connection: RobotConnection, pictures: PictureSubscriber | None = None) -> None:
        """`pictures`: of the cameras that are heard on `connection`."""
        self._connection = connection
        self._pictures = pictures or PictureSubscriber.of(connection, "record")
        self._taken: list[RawSample] = []
        connection.subscribe(CAMERA_STATE)

    def wait(self, stopping: StopSignal, seconds: float) -> bool:
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            if stopping.wait(min(_TURN, left)):
                return True
            self._poll()
        return False

    def pop_all(self) -> list[RawSample]:
        for trouble in self._pictures.troubles():
            print_error(f"no picture: {trouble}")
        taken, self._taken = self._taken, []
        return taken

    def close(self) -> None:
        self._pictures.close()

    def _poll(self) -> None:
        self._connection.dispatch(self._pictures)
        for seen in self._pictures.pop_pictures():
            key, sample = key_of(self._connection.robot, seen.topic), seen.picture
            self._taken.append(RawSample(time.monotonic_ns(), key, encode(sample), encoding_of(type(sample))))
