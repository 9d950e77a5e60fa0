"""Samples as a recorder hears them."""

from pathlib import Path
from typing import Any

import msgspec

from giraff_mcap.raw_sample import RawSample
from giraff_mcap.writing import RecordingWriter
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.format import FORMAT
from giraff_schemas.messages import Odometry, RobotTime, Sample
from giraff_schemas.topics import ODOM, Topic, key_of

ROBOT = "sim-test"
ABOUT = {"robot": ROBOT, "format": str(FORMAT)}
"""Metadata of a recording that nobody refuses."""
BEGAN_NS = 1_000_000_000_000
"""By the monotonic clock."""


def odometry(seq: int, instance: str = "made") -> Odometry:
    return Odometry(
        seq=seq,
        stamp_ns=1_700_000_000_000_000_000 + seq,
        instance=instance,
        x=0.1 * seq,
        y=-0.0,
        yaw=1e-17,
        linear_x=0.3,
        angular_z=0.0,
        covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
        path=0.1 * seq,
        board_us=seq * 10_000,
        boot_id=(1 << 32) - 1,
        tick=RobotTime(epoch=7, robot_ns=(1 << 64) - 1),
    )


def heard(sample: Sample, at_ns: int, topic: Topic[Any] = ODOM) -> RawSample:
    """As it comes over the network."""
    return RawSample(at_ns, key_of(ROBOT, topic), encode(sample), encoding_of(type(sample)))


def record(path: Path, *batches: list[RawSample], close: bool = True) -> RecordingWriter:
    """A file of these, on disk batch by batch; not closed: as a crash leaves it."""
    writer = RecordingWriter(path, ABOUT | {"tables": msgspec.json.encode({"robot": {"name": ROBOT}}).decode()})
    with writer:
        for batch in batches:
            writer.add(batch)
            writer.sync()
        if close:
            writer.close("test")
    return writer


def ten(first: int = 0) -> list[RawSample]:
    """Ten samples, 10 ms apart."""
    return [heard(odometry(seq), BEGAN_NS + seq * 10_000_000) for seq in range(first, first + 10)]
