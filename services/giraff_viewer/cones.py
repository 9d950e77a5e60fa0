"""What each ultrasonic sensor sees, and whether the robot may go there. No clock: the time comes in."""

from typing import Final, Literal

from giraff_schemas.messages import GuardState, Range

ConeState = Literal["free", "near", "blocked", "doubted", "fault"]

NEAR: Final = 1.0  # m; an echo from nearer is worth a look
_COUNTS_FOR: Final = 0.5  # s; guard no longer counts on a reading that is older than 0.4 s


class Cone:
    """One sensor. Times are ns of one clock."""

    def __init__(self, sensor: str) -> None:
        self.sensor = sensor
        self._reading: Range | None = None
        self._read_ns = 0
        self._distrust = ""
        self._blocks = False

    def read(self, reading: Range, at_ns: int) -> None:
        """The sensor was heard."""
        self._reading, self._read_ns = reading, at_ns

    def judge(self, guard: GuardState) -> None:
        """What the guard makes of it."""
        self._distrust = str(state.trouble) if (state := guard.sensors.get(self.sensor)) is not None else ""
        verdicts = (guard.forward, guard.backward, guard.turn_left, guard.turn_right)
        self._blocks = any(each.clearance == "blocked" and each.sensor == self.sensor for each in verdicts)

    @property
    def distance(self) -> float | None:
        """m to what was heard last; None: to nothing."""
        return None if self._reading is None else self._reading.range

    def state(self, now_ns: int) -> ConeState:
        """The worst that is known of it."""
        if self._reading is None or self._stale(now_ns) or self._reading.state == "fault":
            return "fault"
        if self._distrust:
            return "doubted" if self._reading.state == "clear" else "fault"
        if self._blocks:
            return "blocked"
        return "free" if self.distance is None or self.distance > NEAR else "near"

    def reason(self, now_ns: int) -> str:
        """Why it cannot be relied on; empty: it can."""
        if self._reading is None:
            return "not heard yet"
        if self._stale(now_ns):
            return f"silent for {(now_ns - self._read_ns) * 1e-9:.1f} s"
        return str(self._reading.reason) or self._distrust

    def _stale(self, now_ns: int) -> bool:
        return (now_ns - self._read_ns) * 1e-9 > _COUNTS_FOR
