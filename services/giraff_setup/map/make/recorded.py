"""`giraff map make --from`: a plan of a drive that was recorded, as fast as it goes."""

from pathlib import Path
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_maps.floor_plan import MapError
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.tables import table_of
from giraff_mcap.unread import Unread
from giraff_node.config.robot_file import ConfigError
from giraff_schemas.codec import DecodeError
from giraff_schemas.scan import LaserScan
from giraff_schemas.topics import SCAN
from giraff_setup.map.make.drive import Drive
from giraff_setup.map.make.finish import finish, wish_of
from giraff_tools.network.command import print_error
from giraff_tools.terminal.progress import Progress
from giraff_tools.terminal.signals import StopSignal

_UPDATE_EVERY: Final = 10  # scans


def make(name: Path, path: Path, *, onto: bool, calibrate: bool, file: Path | None, as_json: bool) -> int:
    """Return the exit code. `onto`, `calibrate`, `file`: as of `Wish`."""
    try:
        wish = wish_of(name, onto=onto, calibrate=calibrate, file=file)
        recording = Recording(path)
        wish.require_robot_file(recording.robot)
        drive = Drive(table_of(recording, "robot", RobotConfig))
        unread = Unread()
        with StopSignal() as stopping, Progress("mapping", shown=not as_json) as progress:
            heard, strange = _feed(recording, drive, stopping, unread, progress)
    except (MapError, RecordingError, ConfigError) as error:
        return print_error(str(error))
    if not (heard or strange):
        return print_error(f"{path}: it has no scan/*; record a drive with `giraff record` while giraff_scan runs")
    for line in recording.faults(unread, strange):
        print_error(f"{path}: {line}")
    if stopping.asked:
        print_error(f"{path}: ended early; this is of what came before")
    return finish(drive, recording.robot, wish, as_json=as_json, is_whole=not (unread or strange))


def _feed(
    recording: Recording, drive: Drive, stopping: StopSignal, unread: Unread, progress: Progress
) -> tuple[int, int]:
    """Return how many scans there were, and how many others cannot be decoded. `unread` takes what is missing."""
    heard = strange = 0
    for number, recorded in enumerate(recording.samples((SCAN.key,), unread)):
        if number % _UPDATE_EVERY == 0:
            progress.move(recording.share_before(recorded.heard_ns))
        if stopping.asked:
            break
        try:
            scan = recorded.decode()
        except DecodeError:
            strange += 1
            continue
        if isinstance(scan, LaserScan):
            heard += 1
            drive.add(scan)
    return heard, strange
