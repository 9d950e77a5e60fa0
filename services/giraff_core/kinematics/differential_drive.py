"""Two wheels on one axle: Siegwart, Nourbakhsh, Introduction to Autonomous Mobile Robots, section 3.2."""

from typing import Final, NamedTuple

CREEP: Final = 0.10
"""m/s at most of a robot that cannot trust what it senses."""


class DifferentialDrive(NamedTuple):
    """The drive of one robot. Turns to the left are positive (REP-103)."""

    track_width: float
    """m between the wheels' contact points."""
    max_wheel_speed: float
    """m/s."""

    def wheel_speeds(self, linear: float, angular: float) -> tuple[float, float]:
        """Speeds of the left and the right wheel (m/s) for a twist (m/s, rad/s)."""
        half_turn = angular * self.track_width / 2
        return linear - half_turn, linear + half_turn

    def twist(self, left: float, right: float) -> tuple[float, float]:
        """The twist (m/s, rad/s) for wheel speeds (m/s); or the arc (m, rad) for what each wheel has travelled (m)."""
        return (left + right) / 2.0, (right - left) / self.track_width

    def within_limits(self, linear: float, angular: float) -> tuple[float, float]:
        """The same curve (m/s, rad/s), slowed until its faster wheel keeps to `max_wheel_speed`."""
        faster_wheel = abs(linear) + abs(angular) * self.track_width / 2.0
        if faster_wheel <= self.max_wheel_speed:
            return linear, angular
        scale = self.max_wheel_speed / faster_wheel
        return linear * scale, angular * scale

    @property
    def fastest_spin(self) -> float:
        """rad/s with both wheels at full speed, against each other."""
        return 2.0 * self.max_wheel_speed / self.track_width
