"""`giraff vision --from`: pictures of a recording or a video through the policy of giraff_vision, one at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple, Protocol

# FFmpeg prints by itself what is wrong with a video. It reads this when the first one is opened.
os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_cli.network.command import print_error
from giraff_cli.terminal.screen import say
from giraff_cli.terminal.signals import StopSignal
from giraff_cli.terminal.text import json_page
from giraff_cli.vision.summary import Tally, to_text
from giraff_core.robot import RobotConfig
from giraff_core.sensors import Camera
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.tables import table_of
from giraff_mcap.unread import Unread
from giraff_node.config.robot_file import ConfigError, load
from giraff_schemas.camera import Picture
from giraff_schemas.checks import refuse_to_read
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.topics import CAMERA_PICTURES, ODOM
from giraff_vision.config import VisionConfig
from giraff_vision.policy import VisionPolicy, grey_of

_INCOMPLETE: Final = 1
_USUAL_RATE: Final = 15.0  # Hz
_MOST_RATE: Final = 1000.0  # Hz
_MOST_READ: Final = 0.98
"""Share of a video's pictures from which it counts as whole. Some files tell their number by their length only."""


class Frame(NamedTuple):
    """One picture."""

    picture: Picture
    grey: NDArray[np.uint8]
    at_ns: int
    """ns of any one clock."""


class Source(Protocol):
    """A file of pictures."""

    camera: Camera
    faults: list[str]
    """Lines about what could not be read, once all frames were taken."""

    def frames(self) -> Iterator[Odometry | Frame]:
        """Read them in their order."""
        ...


def look(path: Path, camera: str | None, file: Path | None, *, as_json: bool) -> int:
    """Return the exit code. `camera`, `file`: as they were typed."""
    try:
        source: Source = (_Recorded if path.suffix == ".mcap" else _Video)(path, camera, file)
        tally = Tally()
        with StopSignal() as stopping:
            _watch(source, tally, stopping)
    except (ConfigError, RecordingError, ValueError) as error:
        return print_error(str(error))
    if stopping.asked:
        print_error(f"{path}: ended early; this is of what came before")
    for fault in source.faults:
        print_error(f"{path}: {fault}")
    if not tally.pictures:
        return print_error(f"{path}: none of its pictures can be read")
    summary = tally.summary()
    say(json_page(summary) if as_json else to_text(summary))
    return _INCOMPLETE if source.faults else 0


def _watch(source: Source, tally: Tally, stopping: StopSignal) -> None:
    policy = VisionPolicy(source.camera)
    for each in source.frames():
        if stopping.asked:
            return
        if isinstance(each, Odometry):
            policy.on_odometry(each)
        else:
            tally.take(policy.on_picture(each.picture, each.grey), each.at_ns)


def _camera(robot: RobotConfig, vision: VisionConfig, typed: str | None) -> tuple[str, Camera]:
    """Return name and table of the camera that is meant. Raises ValueError."""
    if typed is None and vision.camera:
        return robot.camera(vision.camera, "[vision] camera")
    return robot.camera(typed or "", "--camera")


def _filed(file: Path | None) -> tuple[RobotConfig, VisionConfig]:
    """Read the robot file. Raises ConfigError."""
    if file is not None and not file.is_file():
        raise ConfigError(f"--file {file}: there is no such file")
    environment = os.environ if file is None else {**os.environ, "GIRAFF_CONFIG": str(file)}
    return load("robot", RobotConfig, environment), load("vision", VisionConfig, environment)


class _Recorded:
    """A recording. Its robot file counts, and where it has none, the one at hand."""

    def __init__(self, path: Path, camera: str | None, file: Path | None) -> None:
        """Raises RecordingError, ConfigError and ValueError."""
        self._recording = recording = Recording(path)
        self.faults: list[str] = []
        if file is not None:
            robot, vision = _filed(file)
        else:
            try:
                robot, vision = table_of(recording, "robot", RobotConfig), table_of(recording, "vision", VisionConfig)
            except ConfigError as error:
                raise ConfigError(f"{error}; name the robot's file: --file FILE") from error
        self.name, self.camera = _camera(robot, vision, camera)
        self._pictures = {topic.at(self.name).key for topic in CAMERA_PICTURES}
        if not self._pictures & set(recording.keys):
            raise ValueError(f"{path}: no pictures of {self.name} in it; record them with giraff record --camera")

    def frames(self) -> Iterator[Odometry | Frame]:
        unread, strange = Unread(), 0
        for recorded in self._recording.samples((ODOM.key, *self._pictures), unread):
            try:
                sample = recorded.decode()
                heard = (
                    Frame(sample, grey_of(sample.jpeg), recorded.heard_ns) if isinstance(sample, Picture) else sample
                )
            except ValueError:
                strange += 1
                continue
            if isinstance(heard, Odometry | Frame):
                yield heard
        if strange:
            self.faults.append(f"{strange} samples could not be read, and are left out")
        if not self._recording.whole:
            self.faults.append("cut off; this is of what is there")
        self.faults += unread.texts()


class _Video:
    """A video file. It has no wheels, and its camera is the robot file's."""

    def __init__(self, path: Path, camera: str | None, file: Path | None) -> None:
        """Raises ConfigError and ValueError."""
        if why := refuse_to_read(path):
            raise ValueError(why)
        try:
            path.open("rb").close()
        except OSError as error:
            raise ValueError(f"{path}: {error.strerror}") from error
        self.faults: list[str] = []
        self.name, self.camera = _camera(*_filed(file), camera)
        self._video = cv2.VideoCapture(str(path))
        if not self._video.isOpened():
            raise ValueError(
                f"{path}: OpenCV cannot read it as a video; give an .avi or .mp4 that is whole, or a recording, whose "
                "name ends in .mcap"
            )

    def frames(self) -> Iterator[Frame]:
        video, camera, number = self._video, self.camera, 0
        rate = video.get(cv2.CAP_PROP_FPS)
        period_ns = round(1e9 / (rate if 0.0 < rate <= _MOST_RATE else _USUAL_RATE))
        while (read := video.read())[0]:
            grey = np.asarray(cv2.cvtColor(read[1], cv2.COLOR_BGR2GRAY), np.uint8)
            height, width = grey.shape
            if width > camera.width and abs(width * camera.height - height * camera.width) <= width / 2:
                # As giraff_camera does with a camera that gives larger pictures.
                size = camera.width, camera.height
                grey = np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), np.uint8)
            moment = RobotTime(epoch=1, robot_ns=number * period_ns)
            picture = Picture(seq=number, camera=self.name, jpeg=b"", width=width, height=height, tick=moment)
            yield Frame(picture, grey, moment.robot_ns)
            number += 1
        told = video.get(cv2.CAP_PROP_FRAME_COUNT)
        if number < _MOST_READ * told:
            self.faults.append(f"only {number} of its {told:.0f} pictures can be read; this is of what came before")
