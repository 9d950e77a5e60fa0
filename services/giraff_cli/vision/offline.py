"""`giraff vision --from`: pictures of a recording or a video through the policy of giraff_vision, one at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final

# FFmpeg prints by itself what is wrong with a video. It reads this when the first one is opened.
os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_cli.vision.summary import Tally, to_text
from giraff_core.picture.header import MOST_PIXELS
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
from giraff_tools.network.command import print_error
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import json_page
from giraff_vision.config import VisionConfig
from giraff_vision.policy import VisionPolicy, grey_of

Frame = tuple[Picture, NDArray[np.uint8], int]
"""A picture, and when it was heard or taken: ns of any one clock."""

_INCOMPLETE: Final = 1
_USUAL_RATE, _MOST_RATE = 15.0, 1000.0  # Hz
_MOST_READ: Final = 0.98
"""Share of a video's pictures from which it counts as whole. Some files tell their number by their length only."""


def measure_recording(path: Path, camera: str | None, file: Path | None, *, as_json: bool) -> int:
    """Return the exit code. `camera`, `file`: as they were typed."""
    faults: list[str] = []
    tally = Tally()
    try:
        if path.suffix == ".mcap":
            recording = Recording(path)
            name, model = _camera(camera, file, recording)
            frames = _recorded(recording, name, model, faults)
        else:
            video = _opened(path)
            name, model = _camera(camera, file)
            frames = _filmed(video, name, model, faults)
        policy = VisionPolicy(model)
        with StopSignal() as stopping:
            for each in frames:
                if stopping.asked:
                    faults.append("ended early; this is of what came before")
                    break
                if isinstance(each, Odometry):
                    policy.on_odometry(each)
                else:
                    picture, grey, at_ns = each
                    tally.add(policy.on_picture(picture, grey), at_ns)
    except (ConfigError, RecordingError, ValueError) as error:
        return print_error(str(error))
    for fault in faults:
        print_error(f"{path}: {fault}")
    summary = tally.summary
    if not summary.pictures:
        remedy = "record them with giraff record --camera" if path.suffix == ".mcap" else "give a video that plays"
        return print_error(f"{path}: no picture of {name} in it; {remedy}")
    say(json_page(summary) if as_json else to_text(summary))
    return _INCOMPLETE if faults else 0


def _camera(typed: str | None, file: Path | None, recording: Recording | None = None) -> tuple[str, Camera]:
    """Return name and table of the camera that is meant. Raises RecordingError, ConfigError and ValueError."""
    if recording is not None and file is None:
        robot, vision = table_of(recording, "robot", RobotConfig), table_of(recording, "vision", VisionConfig)
    else:
        if file is not None and not file.is_file():
            raise ConfigError(f"--file {file}: there is no such file")
        environment = os.environ if file is None else {**os.environ, "GIRAFF_CONFIG": str(file)}
        robot, vision = load("robot", RobotConfig, environment), load("vision", VisionConfig, environment)
    if typed is None and vision.camera:
        return robot.camera(vision.camera, "[vision] camera")
    return robot.camera(typed or "", "--camera")


def _recorded(recording: Recording, name: str, camera: Camera, faults: list[str]) -> Iterator[Odometry | Frame]:
    """Read a recording. `faults` takes what cannot be read."""
    unread, strange = Unread(), 0
    for recorded in recording.samples((ODOM.key, *(topic.at(name).key for topic in CAMERA_PICTURES)), unread):
        try:
            sample = recorded.decode()
            grey = grey_of(sample.jpeg, camera) if isinstance(sample, Picture) else None
        except ValueError:
            strange += 1
            continue
        if isinstance(sample, Odometry):
            yield sample
        elif isinstance(sample, Picture) and grey is not None:
            yield sample, grey, recorded.heard_ns
    faults += [f"{strange} samples could not be read, and are left out"] if strange else []
    faults += [] if recording.whole else ["cut off; this is of what is there"]
    faults += unread.texts()


def _opened(path: Path) -> cv2.VideoCapture:
    """Open a video. Raises ValueError."""
    try:
        if why := refuse_to_read(path):
            raise ValueError(why)
        path.open("rb").close()
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}") from error
    if not (video := cv2.VideoCapture(str(path))).isOpened():
        what = "OpenCV cannot read it as a video; give an .avi or .mp4 that is whole, or a recording"
        raise ValueError(f"{path}: {what}, whose name ends in .mcap")
    width, height = video.get(cv2.CAP_PROP_FRAME_WIDTH), video.get(cv2.CAP_PROP_FRAME_HEIGHT)
    if width * height > MOST_PIXELS:  # known before the first picture is decoded
        raise ValueError(f"{path}: its pictures have {width:.0f} x {height:.0f} px; give smaller ones")
    return video


def _filmed(video: cv2.VideoCapture, name: str, camera: Camera, faults: list[str]) -> Iterator[Frame]:
    """Read a video. `faults` takes what cannot be read."""
    rate, number = video.get(cv2.CAP_PROP_FPS), 0
    period_ns = round(1e9 / (rate if 0.0 < rate <= _MOST_RATE else _USUAL_RATE))
    while (read := video.read())[0]:
        grey = np.asarray(cv2.cvtColor(read[1], cv2.COLOR_BGR2GRAY), np.uint8)
        height, width = grey.shape
        if width > camera.width and abs(width * camera.height - height * camera.width) <= width / 2:
            # As giraff_camera does with a device that gives larger pictures.
            grey = np.asarray(cv2.resize(grey, (camera.width, camera.height), interpolation=cv2.INTER_AREA), np.uint8)
        at_ns = number * period_ns
        tick = RobotTime(epoch=1, robot_ns=at_ns)
        yield Picture(seq=number, camera=name, jpeg=b"", width=width, height=height, tick=tick), grey, at_ns
        number += 1
    if number < _MOST_READ * (told := video.get(cv2.CAP_PROP_FRAME_COUNT)):
        faults.append(f"only {number} of its {told:.0f} pictures can be read; this is of what came before")
