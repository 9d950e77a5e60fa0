"""Makes a whole recording of one that was cut off or damaged: with index, counts and an end."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording
from giraff_mcap.writing import RecordingWriter

_BATCH: Final = 500


def repair(path: Path, into: Path, on_share: Callable[[float], None] = lambda _: None) -> RecordingWriter:
    """Write the new file, which says what is missing; return its writer, closed.

    `on_share` is given the share, 0 to 1, that is done.

    Raises RecordingError where nothing can be saved, OSError where it cannot be written.
    """
    recording = Recording(path, any_format=True)
    with RecordingWriter(into, recording.about, to_wall_ns=0) as writer:
        batch: list[RawSample] = []
        for sample in recording.samples(unread=writer.unread):
            batch.append(RawSample(sample.heard_ns, sample.topic, sample.payload, sample.encoding))
            if len(batch) == _BATCH:
                writer.add(batch)
                writer.sync()
                batch.clear()
                on_share(recording.share_before(sample.heard_ns))
        writer.add(batch)
        missing = "".join(f"; {line}" for line in writer.unread.texts())
        writer.close(f"a repair of {path.name}{missing}")
    return writer
