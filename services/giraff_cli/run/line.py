"""A run in one line, for where there is no terminal."""

from __future__ import annotations

import math

from giraff_cli.run.telemetry import RunSnapshot
from giraff_core.kinematics.pose import Pose
from giraff_telemetry.describe import base_text, forward_text, localization_text, range_text
from giraff_telemetry.visual_odometry import visual_text


def line(snapshot: RunSnapshot, elapsed: float) -> str:
    """`elapsed`: s since the run began."""
    truth, pose = snapshot.truth, snapshot.true_pose or Pose(0.0, 0.0, 0.0)
    parts = [
        f"{elapsed:6.1f} s",
        f"x {pose.x:z6.2f} y {pose.y:z6.2f} m, {math.degrees(pose.yaw):z6.1f}°",
        f"path {truth.path:6.2f} m",
        f"{truth.speed:z5.2f} m/s",
        "ranges " + " ".join(f"{range_text(seen):>6}" for seen in snapshot.ranges.values()),
        f"forward {forward_text(snapshot.guard)}",
        f"base {base_text(snapshot)}",
        f"lost {sum(rate.lost for rate in snapshot.rates.values())}",
    ]
    if snapshot.localization is not None:
        parts.append(f"map {localization_text(snapshot)}")
    if (off := snapshot.off_map) is not None:
        parts.append(f"off {off.distance:.2f} m, {math.degrees(off.angle):.1f}°")
    if snapshot.seen is not None:
        parts.append(f"camera {visual_text(snapshot.seen)}")
    return " | ".join(parts)
