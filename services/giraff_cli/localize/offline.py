"""`giraff localize --from`: a recording through localization, as fast as it goes, and a summary of it."""

import time
from pathlib import Path
from textwrap import fill
from typing import Final

import msgspec

from giraff_cli.localize.client import DONE, REFUSED, told_pose
from giraff_cli.localize.floor import floor_of
from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_localization.config import LocalizationConfig
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.floor_plan import MapError
from giraff_maps.read import read_map
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.tables import table_of
from giraff_mcap.unread import Unread
from giraff_node.config.robot_file import ConfigError
from giraff_schemas.codec import DecodeError
from giraff_schemas.messages import Odometry, Range, Sample, TruePose
from giraff_schemas.scan import LaserScan
from giraff_schemas.text import printable
from giraff_schemas.topics import ODOM, POSE, RANGE, SCAN, TRUE_POSE
from giraff_sim.world.room import Room, RoomError, read_room
from giraff_telemetry.localization import WayByState
from giraff_telemetry.localization_error import LocalizationErrors
from giraff_telemetry.localization_summary import WIDTH, LocalizationSummary, localization_rows, summarize_localization
from giraff_tools.network.command import print_error
from giraff_tools.terminal.progress import Progress
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import json_page

_LOOK_EVERY: Final = 100  # samples
_INCOMPLETE: Final = 1
_LABEL: Final = 15  # characters
_INDENT: Final = " " * (_LABEL + 2)
_POSE_EVERY_NS: Final = round(1e9 / POSE.rate_hz)
_NEAREST: Final = 0.02  # m: the centre of a robot is never so near to a wall


def localize(path: Path, map_path: Path, place: Pose | None, *, as_json: bool) -> int:
    """The exit code. `place`: where the robot was at the first of it; None: anywhere."""
    try:
        plan = read_map(map_path)
        recording = Recording(path)
        config = msgspec.structs.replace(table_of(recording, "localization", LocalizationConfig), map=str(map_path))
        robot = table_of(recording, "robot", RobotConfig)
        floor = floor_of(map_path, plan, config, robot)
        with StopSignal() as stopping:
            began = time.monotonic()
            drive = RecordedDrive(LocalizationPolicy(config, robot, floor), place, _room(map_path))
            unread = Unread()
            with Progress("localizing", shown=not as_json) as progress:
                strange = _feed(recording, drive, stopping, unread, progress)
            took = time.monotonic() - began
    except (MapError, RecordingError, ConfigError) as error:
        return print_error(str(error))
    for line in recording.faults(unread, strange):
        print_error(f"{path}: {line}")
    if drive.refused:
        print_error(f"--at: {drive.refused}")
        return REFUSED
    if stopping.asked:
        print_error(f"{path}: ended early; this is of what came before")
    if not drive.heard_odometry:
        return print_error(f"{path}: it has no odom, and so no way; record odom and range/* or scan/* (giraff record)")
    summary = summarize(drive, recording.robot, took=took)
    say(to_json(summary) if as_json else to_text(summary))
    return _INCOMPLETE if unread or strange else DONE


def _feed(
    recording: Recording, drive: "RecordedDrive", stopping: StopSignal, unread: Unread, progress: Progress
) -> int:
    """Return how many samples cannot be decoded. `unread` takes what is missing in the file."""
    strange = 0
    for number, recorded in enumerate(recording.samples((ODOM.key, RANGE.key, SCAN.key, TRUE_POSE.key), unread)):
        if number % _LOOK_EVERY == 0:
            progress.move(recording.share_before(recorded.heard_ns))
            if stopping.asked:
                break
        try:
            drive.on_sample(recorded.decode(), recorded.heard_ns)
        except DecodeError:
            strange += 1
    return strange


def _room(path: Path) -> Room | None:
    """The map as a room, which says where a run starts in it; None: it is none."""
    try:
        return read_room(path)
    except RoomError:
        return None


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """As `--json` prints it."""

    robot: str
    seconds: float
    """Of the recording."""
    factor: float
    """How many times faster than real time it went."""
    way_m: float
    """By odometry."""
    localization: LocalizationSummary
    doubt: str
    """Why the truth that the recording has says nothing of this map; empty: it does, or there is none."""


def summarize(drive: "RecordedDrive", robot: str, *, took: float) -> Summary:
    """`took`: s that it has taken."""
    errors = LocalizationErrors() if drive.truth.doubt else drive.errors  # what was compared before the doubt is in it
    return Summary(
        robot=robot,
        seconds=round(drive.seconds, 3),
        factor=round(drive.seconds / took, 1) if took > 0.0 else 0.0,
        way_m=round(drive.way, 3),
        localization=summarize_localization(drive.policy.pose(), drive.shares, errors),
        doubt=drive.truth.doubt if drive.has_truth else "",
    )


def to_json(summary: Summary) -> str:
    return json_page(summary)


def to_text(summary: Summary) -> str:
    """For people."""
    rows = [
        ("recording", f"of {summary.robot}, {summary.seconds:.1f} s, {summary.factor:g} times faster than real time"),
        ("map", printable(summary.localization.map)),
        ("way", f"{summary.way_m:.2f} m by odometry"),
        *localization_rows(summary.localization),
    ]
    if summary.doubt:
        rows.append(("truth", fill(f"not told: {summary.doubt}", WIDTH)))
    indented = ((label, value.replace("\n", f"\n{_INDENT}")) for label, value in rows)
    return "\n".join(f"{label:>{_LABEL}}  {value}" for label, value in indented)


class TrueWay:
    """Where a simulated robot truly was on the map: `true_pose` is in `odom`, which began where the room says.

    That holds only as long as odometry is the one that began there, and its pose was never set.
    """

    def __init__(self, room: Room | None) -> None:
        """`room`: that the map is of; None: it is of none, and has no start."""
        self._room = room
        self._segment: tuple[str, int] | None = None
        self.doubt = "" if room is not None else "this map does not say where a run starts on it"
        """Why nothing can be told of it; empty: nothing speaks against it."""

    def on_odometry(self, odometry: Odometry) -> None:
        """Each in turn."""
        segment = odometry.segment
        if odometry.jumps or (self._segment is not None and segment != self._segment):
            self.doubt = self.doubt or "odometry began anew on the way, or its pose was set"
        self._segment = segment

    def on_map(self, pose: TruePose) -> Pose | None:
        """Where that is; None: it cannot be told."""
        if self._room is None or self.doubt:
            return None
        true = Pose(pose.x, pose.y, pose.yaw).placed_in(Pose(*self._room.start))
        if self._room.clearance(true.x, true.y) < _NEAREST:
            self.doubt = "it would lead through a wall: the recording is of another room, or began elsewhere in it"
            return None
        return true


class RecordedDrive:
    """Give it all samples in the order in which they were heard."""

    def __init__(self, policy: LocalizationPolicy, place: Pose | None, room: Room | None) -> None:
        """`place`: where the robot is when odometry is first heard; None: anywhere. `room`: as of `TrueWay`."""
        self.policy = policy
        self.way = 0.0
        """m, by odometry."""
        self.seconds = 0.0
        """From the first sample to the last."""
        self.refused = ""
        """Why the robot cannot have been where it was said to be."""
        self.shares = WayByState()
        self.errors = LocalizationErrors()
        self.truth = TrueWay(room)
        self.has_truth = False
        self._place = place
        self._first_ns: int | None = None
        self._path: float | None = None
        self._segment = ("", 0)
        self._next_ns: int | None = None
        self._work()  # the map is read

    @property
    def heard_odometry(self) -> bool:
        return self._path is not None

    def on_sample(self, sample: Sample, at_ns: int) -> None:
        """`at_ns`: when it was heard, ns of any one clock."""
        self._first_ns = at_ns if self._first_ns is None else self._first_ns
        self.seconds = max(self.seconds, (at_ns - self._first_ns) * 1e-9)
        match sample:
            case Odometry():
                self._on_odometry(sample)
            case Range() | LaserScan():
                self.policy.on_sample(sample)
            case TruePose():
                self.has_truth = True
                if (true := self.truth.on_map(sample)) is not None:
                    self.errors.see(sample.tick.robot_ns, true)
            case _:
                return
        self._work()
        if self.heard_odometry and (self._next_ns is None or at_ns >= self._next_ns):
            self._next_ns = at_ns + _POSE_EVERY_NS
            self._take_pose()

    def _on_odometry(self, odometry: Odometry) -> None:
        self.truth.on_odometry(odometry)
        self.policy.on_odometry(odometry)
        if odometry.segment == self._segment and self._path is not None:
            self.way += max(0.0, odometry.path - self._path)
        self._path, self._segment = odometry.path, odometry.segment
        if self._place is not None:
            answer = self.policy.on_set_pose(told_pose(self._place))
            self.refused = "" if answer.done else str(answer.reason)
            self._place = None

    def _work(self) -> None:
        while self.policy.work():
            pass

    def _take_pose(self) -> None:
        pose = self.policy.pose()
        self.shares.come(self.way, pose.state)
        self.errors.on_pose(pose)
