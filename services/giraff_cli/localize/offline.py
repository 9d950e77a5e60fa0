"""`giraff localize --from`: a recording through localization, as fast as it goes, and a summary of it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Final

import msgspec

from giraff_cli.localize.client import DONE, REFUSED
from giraff_cli.localize.floor import floor_of
from giraff_cli.localize.recorded import RecordedDrive
from giraff_cli.localize.summary import summarize, to_json, to_text
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
from giraff_schemas.topics import ODOM, RANGE, TRUE_POSE
from giraff_sim.world.room import Room, RoomError, read_room
from giraff_tools.network.command import print_error
from giraff_tools.terminal.progress import Progress
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.signals import StopSignal

_LOOK_EVERY: Final = 100  # samples
_INCOMPLETE: Final = 1


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
    if strange:
        print_error(f"{path}: {strange} samples could not be read, and are left out")
    if not recording.whole:
        print_error(f"{path}: cut off; this is of what is there")
    for line in unread.texts():
        print_error(f"{path}: {line}")
    if drive.refused:
        print_error(f"--at: {drive.refused}")
        return REFUSED
    if stopping.asked:
        print_error(f"{path}: ended early; this is of what came before")
    if not drive.heard_odometry:
        return print_error(f"{path}: it has no odom, and so no way; record with odom and range/* (giraff record)")
    summary = summarize(drive, recording.robot, took=took)
    say(to_json(summary) if as_json else to_text(summary))
    return _INCOMPLETE if unread or strange else DONE


def _feed(recording: Recording, drive: RecordedDrive, stopping: StopSignal, unread: Unread, progress: Progress) -> int:
    """Return how many samples cannot be decoded. `unread` takes what is missing in the file."""
    strange = 0
    for number, recorded in enumerate(recording.samples((ODOM.key, RANGE.key, TRUE_POSE.key), unread)):
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
