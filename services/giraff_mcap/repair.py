"""A recording that was cut off becomes a whole one: with index, counts and an end."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.writing import RecordingWriter

_BATCH: Final = 500


def repair(path: Path, into: Path) -> RecordingWriter:
    """The new file, closed. Raises RecordingError where nothing can be saved, OSError where it cannot be written."""
    recording = Recording(path)
    with RecordingWriter(into, recording.about, to_wall_ns=0) as writer:
        batch: list[RawSample] = []
        damage = ""
        try:
            for sample in recording.samples():
                batch.append(
                    RawSample(
                        at_ns=sample.heard_ns,
                        key=sample.topic,
                        payload=sample.payload(),
                        encoding=sample.encoding,
                    )
                )
                if len(batch) == _BATCH:
                    writer.add(batch)
                    writer.sync()
                    batch.clear()
        except RecordingError as error:  # further on; what came before is whole
            damage = f": {error}"
        writer.add(batch)
        writer.close(f"a repair of {path.name}{damage}")
    return writer
