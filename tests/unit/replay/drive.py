"""The recorded drive of a simulated robot; `tests/functional/desk/make_drive.py` makes it anew."""

from pathlib import Path
from typing import Final

from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recorded, Recording
from giraff_mcap.writing import RecordingWriter
from tests.unit.mcap.recordings import ABOUT

DRIVE: Final = Path(__file__).with_name("data") / "drive.mcap"


def begin_of_the_drive(path: Path, duration_ns: int) -> list[Recorded]:
    """A file of its first so many ns, and what is in it."""
    samples = list(Recording(DRIVE).samples())
    recorded = [sample for sample in samples if sample.heard_ns < samples[0].heard_ns + duration_ns]
    with RecordingWriter(path, ABOUT) as writer:
        writer.add([RawSample(sample.heard_ns, sample.topic, sample.payload, sample.encoding) for sample in recorded])
        writer.close("test")
    return recorded
