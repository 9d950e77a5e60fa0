"""A run in one line, for where there is no terminal."""

from __future__ import annotations

import math

from giraff_cli.motion import Pose
from giraff_cli.telemetry import Seen, Snapshot
from giraff_schemas.messages import GuardState, Range


def line(snapshot: Snapshot, elapsed: float) -> str:
    """`elapsed`: s since the run began."""
    truth, pose = snapshot.truth, snapshot.true_pose or Pose(0.0, 0.0, 0.0)
    parts = [
        f"{elapsed:6.1f} s",
        f"x {pose.x:z6.2f} y {pose.y:z6.2f} m, {math.degrees(pose.yaw):z6.1f}°",
        f"path {truth.path:6.2f} m",
        f"{truth.speed:z5.2f} m/s",
        "ranges " + " ".join(f"{range_text(seen):>6}" for seen in snapshot.ranges.values()),
        f"forward {_forward(snapshot.guard)}",
        f"base {base_text(snapshot)}",
        f"lost {sum(rate.lost for rate in snapshot.rates.values())}",
    ]
    return " | ".join(parts)


def range_text(seen: Seen[Range] | None) -> str:
    """A range in a word."""
    if seen is None or not seen.fresh:
        return "silent"
    return seen.sample.state if seen.sample.range is None else f"{seen.sample.range:.2f} m"


def base_text(snapshot: Snapshot) -> str:
    """What base does, in a word or two."""
    base, estop = snapshot.base, snapshot.estop
    if base is None or not base.fresh:
        return "silent"
    if estop is not None and estop.sample.engaged:
        return "EMERGENCY STOP"
    if base.sample.board.latch not in ("", "none"):
        return f"latched, {base.sample.board.latch.replace('_', ' ')}"
    if not base.sample.armed:
        return "not armed"
    return "driving" if base.sample.driving else "armed, at rest"


def _forward(seen: Seen[GuardState] | None) -> str:
    if seen is None or not seen.fresh:
        return "unknown"
    verdict = seen.sample.forward
    return verdict.freedom if not verdict.sensor else f"{verdict.freedom} ({verdict.sensor})"
