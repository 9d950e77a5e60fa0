"""`giraff vision --from`: pictures of a recording or a video through the policy of giraff_vision, one at a time."""

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final

# FFmpeg prints by itself what is wrong with a video. It reads this when the first one is opened.
os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.pose import Pose
from giraff_core.picture.header import MOST_PIXELS
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.tables import table_of
from giraff_mcap.unread import Unread
from giraff_node.config.robot_file import ConfigError, load
from giraff_schemas.camera import Picture, Step, VisualOdometry
from giraff_schemas.checks import refuse_to_read
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.text import printable
from giraff_schemas.topics import CAMERA_PICTURES, ODOM
from giraff_telemetry.localization import place_text
from giraff_tools.network.command import print_error
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import counted, json_page
from giraff_vision.config import VisionConfig
from giraff_vision.policy import VisionPolicy, disagrees, grey_of

Frame = tuple[Picture, NDArray[np.uint8], int]
"""A picture, and when it was heard or taken: ns of any one clock."""

_INCOMPLETE: Final = 1
_LABEL: Final = 15  # characters
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
    faults += recording.faults(unread, strange)


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


class DrivenPath(msgspec.Struct, frozen=True, kw_only=True):
    """A path, and its end in the `base_link` of the first picture."""

    way_m: float = 0.0
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    """rad."""


class Summary(msgspec.Struct, kw_only=True):
    """As `--json` prints it."""

    camera: str = ""
    width: int = 0
    """px; size of the pictures."""
    height: int = 0
    seconds: float = 0.0
    """s from the first picture to the last."""
    pictures: int = 0
    measured: int = 0
    """Pictures that are a measurement."""
    reasons: dict[str, int] = {}
    """Pictures that are none, by what is wrong."""
    by_camera: DrivenPath = DrivenPath()
    """What was measured, and what the wheels say where nothing was."""
    blind_m: float = 0.0
    """m of it that are the wheels' word."""
    by_wheels: DrivenPath | None = None
    """None: they were not heard."""
    without_wheels: int = 0
    """Pictures after the first at which the wheels were not heard: `by_wheels` lacks their motion."""
    worst: tuple[float, Step, Step] | None = None
    """Largest disagreement: s since the first picture, and the motions since a key picture by camera and wheels."""


class Tally:
    """Takes what is said of each picture."""

    def __init__(self) -> None:
        self.summary = Summary()
        self._said: VisualOdometry | None = None
        self._first_ns = 0
        self._key_wheels = self._wheels = Pose(0.0, 0.0, 0.0)
        self._most_off = 0.0

    def add(self, said: VisualOdometry, at_ns: int) -> None:
        """Take the next. `at_ns`: when its picture was taken or heard, ns of any one clock."""
        summary, before, self._said = self.summary, self._said, said
        if before is None:
            self._first_ns = at_ns
        else:
            self._key_wheels = self._wheels if said.key != before.key else self._key_wheels
            summary.without_wheels += said.wheels is None
        summary.camera, summary.width, summary.height = said.camera, said.width, said.height
        summary.seconds = (at_ns - self._first_ns) * 1e-9
        summary.pictures += 1
        summary.measured += said.is_measured
        if why := said.reason.what:
            summary.reasons[why] = summary.reasons.get(why, 0) + 1
        x, y, yaw = said.path
        summary.by_camera = DrivenPath(way_m=said.seen_m + said.blind_m, x=x, y=y, yaw=yaw)
        summary.blind_m = said.blind_m
        if said.wheels is not None:
            wheels = Pose(*said.wheels).placed_in(self._key_wheels)
            way = 0.0 if summary.by_wheels is None else summary.by_wheels.way_m
            way += math.dist(wheels[:2], self._wheels[:2])
            summary.by_wheels = DrivenPath(way_m=way, x=wheels.x, y=wheels.y, yaw=wheels.yaw)
            self._wheels = wheels
        if disagrees(said) and said.motion and said.wheels:
            off = math.dist(said.motion, said.wheels)  # a metre counts as a radian
            if off > self._most_off:
                self._most_off, summary.worst = off, (summary.seconds, said.motion, said.wheels)


def to_text(summary: Summary) -> str:
    """For people."""
    of, wheels = summary.pictures, summary.by_wheels
    lacks = (
        f"; without {summary.without_wheels} pictures at which they were not heard" if summary.without_wheels else ""
    )
    size = f"{summary.width} x {summary.height} px"
    reasons = sorted(summary.reasons.items(), key=lambda each: -each[1])
    rows = [
        ("camera", f"{summary.camera}, {counted(of, 'picture')} in {summary.seconds:.1f} s, {size}"),
        ("measured", f"{summary.measured} of {counted(of, 'picture')}, {summary.measured / of:.1%}"),
        *(("not", f"{number} of {of}: {reason}") for reason, number in reasons),
        ("by the camera", f"{_way_text(summary.by_camera)}; {summary.blind_m:.2f} m of it by the wheels"),
        ("by the wheels", "not heard" if wheels is None else _way_text(wheels) + lacks),
    ]
    if summary.worst is not None:
        at_s, *steps = summary.worst
        camera, by = (f"{math.hypot(*step[:2]):.3f} m, {math.degrees(step[2]):z.1f}°" for step in steps)
        rows.append(("disagreed most", f"at {at_s:.1f} s: {camera} by the camera, {by} by the wheels"))
    return "\n".join(f"{label:>{_LABEL}}  {printable(value)}" for label, value in rows)


def _way_text(way: DrivenPath) -> str:
    return f"{way.way_m:.2f} m, to {place_text(way.x, way.y, way.yaw)}"
