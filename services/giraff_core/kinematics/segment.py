"""Since when the frame `odom` is where it is: what was found of it before says nothing of it now."""

from __future__ import annotations

from giraff_schemas.messages import Odometry, RobotTime


class Segment:
    """Begins anew where odometry, base's board or the pose does."""

    def __init__(self) -> None:
        self._segment: tuple[str, int, int] | None = None
        self._since: RobotTime | None = None
        self._newest: RobotTime | None = None

    def on_odometry(self, odometry: Odometry) -> None:
        """Take a sample, as it arrives."""
        segment = (*odometry.segment, odometry.boot_id)
        if segment != self._segment:
            self._segment, self._since = segment, odometry.tick
        self._newest = odometry.tick

    def holds(self, tick: RobotTime | None) -> bool:
        """Whether what has this tick is of `odom` as it is now, and of this start of base."""
        since, newest = self._since, self._newest
        if tick is None or since is None or newest is None or tick.epoch != newest.epoch:
            return False
        # Odometry comes oftener than ticks: the tick of its first sample may be of the last of another segment, too.
        return tick.epoch != since.epoch or tick.robot_ns > since.robot_ns
