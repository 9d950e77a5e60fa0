"""`giraff replay`: whether the services of today would do with a recording what those of then did."""

import sys
from collections.abc import Iterator
from io import StringIO
from pathlib import Path

import msgspec
from rich.table import Table
from rich.text import Text

from giraff_cli.replay.agreement import Agreement
from giraff_cli.replay.policies import SETTLES, RecordedSamples, replay_guard, replay_odometry
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_mcap.metadata import ASKED
from giraff_mcap.reading import Recording, RecordingError, params_in
from giraff_mcap.tables import table_of
from giraff_mcap.unread import Unread
from giraff_node.config.robot_file import ConfigError
from giraff_node.process.libraries import missing_library
from giraff_odometry.config import OdometryConfig
from giraff_schemas.camera import Picture, VisualOdometry
from giraff_schemas.codec import DecodeError
from giraff_schemas.services import VISION
from giraff_schemas.topics import CAMERA_PICTURES, VISUAL_ODOM, topic_of
from giraff_telemetry.console import CleanConsole
from giraff_tools.network.command import print_error
from giraff_tools.terminal.text import json_page

_AGREES = 0
_DIFFERS = 1


def replay(path: Path, least: float, *, as_json: bool) -> int:
    """The exit code. `least`: share that must agree."""
    strange: dict[str, str] = {}
    unread = Unread()
    try:
        recording = Recording(path)
        found = agreements(recording, strange, unread)
    except (RecordingError, ConfigError) as error:
        return print_error(str(error))
    if ASKED in recording.about:
        for service in sorted({agreement.service for agreement in found} - recording.described.keys()):
            print_error(f"{path}: {service} did not tell its parameters; it is taken to have gone by the robot file")
    for why in strange.values():
        print_error(f"{path}: left out: {why}")
    for line in unread.texts():
        print_error(f"{path}: {line}")
    compared = [agreement for agreement in found if agreement.compared]
    if not compared:
        return print_error(
            f"{path}: nothing in it can be compared: it takes two samples of wheels and odom, or all that the guard "
            f"hears {_least(recording)}"
        )
    sys.stdout.write(_told(found, as_json=as_json))
    if left := [agreement.key for agreement in found if agreement.left_out and not agreement.compared]:
        return print_error(
            f"{path}: {', '.join(left)}: nothing could be compared in {recording.seconds:.0f} s: it was at work before "
            f"the recording began, or too much is missing; record from its start, or {_least(recording)}"
        )
    agrees = all(agreement.share >= least for agreement in compared)
    return _AGREES if agrees and not strange and not unread else _DIFFERS


def agreements(recording: Recording, strange: dict[str, str], unread: Unread | None = None) -> list[Agreement]:
    """Of each service that can be replayed. Raises RecordingError, and ConfigError where no robot file can be used.

    `strange` takes, by key, why a sample of it cannot be decoded, and so is not compared.
    `unread` takes what is missing in the file.
    """
    said, unread = RecordedSamples(), Unread() if unread is None else unread
    for sample in recording.samples(unread=unread):
        if (answer := params_in(sample)) is not None:
            try:
                said.add_params(answer)
            except ValueError as error:
                strange.setdefault(sample.key, str(error))
        if (topic := topic_of(sample.key)) is None or topic in CAMERA_PICTURES:  # pictures are too large to keep
            continue
        try:
            said.add(sample.decode())
        except DecodeError as error:
            strange.setdefault(sample.key, str(error))
    robot = table_of(recording, "robot", RobotConfig)
    return [
        replay_odometry(said, table_of(recording, "odometry", OdometryConfig), robot),
        *replay_guard(said, table_of(recording, "guard", GuardConfig), robot),
        *_vision(recording, said, robot, strange, unread),
    ]


def _least(recording: Recording) -> str:
    """Return what a recording must have of a guard that was at work before it began."""
    config = table_of(recording, "guard", GuardConfig)
    return f"for {config.memory_time + SETTLES:g} s in which the robot goes {config.trust_end_travel:g} m"


def _vision(
    recording: Recording, said: RecordedSamples, robot: RobotConfig, strange: dict[str, str], unread: Unread
) -> list[Agreement]:
    """Replay visual odometry, where the recording has pictures."""
    told, keys = len(said.of(VisualOdometry)), recording.matching([topic.key for topic in CAMERA_PICTURES])
    if not (told and keys):
        return []

    def pictures() -> Iterator[Picture]:
        for sample in recording.samples(sorted(keys)):
            try:
                if isinstance(picture := sample.decode(), Picture):
                    yield picture
            except DecodeError as error:
                strange.setdefault(sample.key, str(error))

    if not (why := missing_library(VISION)):
        from giraff_cli.replay.vision import replay_vision  # noqa: PLC0415  needs that library

        try:
            return [replay_vision(said, pictures(), robot)]
        except ValueError as error:  # no JPEG, or of another camera
            why = str(error)
    unread.leave_out(VISUAL_ODOM.key, why, told)
    return []


def _told(found: list[Agreement], *, as_json: bool) -> str:
    if as_json:
        rows = [msgspec.structs.asdict(agreement) | {"share": agreement.share} for agreement in found]
        return json_page(rows) + "\n"
    table = Table.grid(padding=(0, 2, 0, 0))
    for agreement in found:
        share = f"{agreement.share:.2%}" if agreement.compared else "nothing to compare"
        table.add_row(
            agreement.service,
            agreement.key,
            Text(f"{agreement.equal} of {agreement.compared}", justify="right"),
            Text(share, justify="right"),
            f"{agreement.left_out} left out" if agreement.left_out else "",
        )
    text = StringIO()
    console = CleanConsole(file=text, width=1000, highlight=False)
    console.print(table)
    for agreement in found:
        if agreement.first:
            console.print(Text(f"{agreement.key}: first difference at {agreement.first}"))
    return "".join(f"{line.rstrip()}\n" for line in text.getvalue().splitlines())
