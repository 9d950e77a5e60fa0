"""`giraff view FILE`: a recording, drawn to its end, and then there to look through."""

from pathlib import Path
from typing import Final

import msgspec

from giraff_cli.view.output import DONE, Options, ViewerOutput, give_up, known_robot
from giraff_core.robot import RobotConfig
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.unread import Unread
from giraff_schemas.codec import DecodeError
from giraff_schemas.topics import topic_of
from giraff_tools.network.command import print_error
from giraff_tools.terminal.signals import StopSignal
from giraff_viewer.window import ViewerError

_LOOK_EVERY: Final = 2000  # samples
_PATIENCE: Final = 0.2  # s
_INCOMPLETE: Final = 1


class RecordingViewer:
    """One recording, and where it is shown."""

    def __init__(self, path: Path, options: Options, stopping: StopSignal) -> None:
        self._path = path
        self._options = options
        self._stopping = stopping

    def run(self) -> int:
        """Until it is drawn, or until the viewer or Ctrl-C ends it; the exit code."""
        try:
            recording = Recording(self._path)
            robot, note = _geometry(recording)
            stage = ViewerOutput(robot, self._options, live=False, note=note)
        except (RecordingError, ViewerError) as error:
            return print_error(str(error))
        try:
            with stage:
                unread = Unread()
                strange = self._draw(recording, stage, unread)
                if strange:
                    print_error(f"{self._path}: {strange} samples could not be read, and are not shown")
                if not recording.whole:
                    print_error(f"{self._path}: cut off; shown is what is there")
                for line in unread.texts():
                    print_error(f"{self._path}: {line}")
                code = stage.end(hurried=self._stopping.asked > 0) if stage.is_open else DONE
                while stage.lasts and stage.is_open and not self._stopping.wait(_PATIENCE):
                    pass
                return code or (_INCOMPLETE if unread or strange else DONE)
        except RecordingError as error:
            return print_error(str(error))
        except ViewerError as error:
            give_up(error)

    def _draw(self, recording: Recording, stage: ViewerOutput, unread: Unread) -> int:
        """Return how many samples cannot be decoded. `unread` takes what is missing in the file."""
        strange = 0
        for number, recorded in enumerate(recording.samples(unread=unread)):
            if number % _LOOK_EVERY == 0 and (self._stopping.asked or not stage.is_open):
                break
            topic = topic_of(recorded.key)
            if topic is None:
                continue  # not of the topics table: nothing that could be drawn
            try:
                stage.show.on_sample(topic, recorded.decode(), recorded.heard_ns)
            except DecodeError:
                strange += 1
            stage.show.update(recorded.heard_ns)
        return strange


def _geometry(recording: Recording) -> tuple[RobotConfig, str]:
    """Return the geometry as it was when it was recorded, if the recording says so; else one with a note."""
    try:
        table = recording.tables()["robot"] | {"name": recording.robot}
        return msgspec.convert(table, RobotConfig, strict=False), ""
    except (KeyError, TypeError, ValueError, RecordingError):
        return known_robot(recording.robot)
