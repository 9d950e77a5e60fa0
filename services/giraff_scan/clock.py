"""The scanner's own clock, by which a packet's age is told however long an adapter has held it. No I/O here."""

from typing import Final

from giraff_scan.ld19 import WRAPS_MS

LATE_NS: Final = 150_000_000
"""A packet that is older when it is read is dropped."""
_WRAPS_NS: Final = WRAPS_MS * 1_000_000
_PATH_NS: Final = 5_000_000
"""From the middle of a packet until it is read at the earliest: 1.3 ms of points, 2 ms on the line, and USB."""
_SETTLES_NS: Final = 1_000_000_000
"""A clock that begins anew is not believed before: an adapter may just be giving up what it has held."""
_SETTLES_AT_MOST_NS: Final = 30_000_000_000
_OFTEN_NS: Final = 60_000_000_000
"""A clock that begins anew again within this time is believed after twice as long: it may say the same again."""
_LOST_NS: Final = 10_000_000_000
"""Silence after which the scanner's time tells nothing: it may have begun anew more than once."""
_SLOWER: Final = 100
"""A clock may be slower than the robot's by one part in so many: that of a cheap oscillator."""


class DeviceClock:
    """Tells when a packet was measured, by the smallest offset between its time and the robot's.

    Bytes that come late have a larger offset. One of them is never taken for fresh: neither after a standstill of the
    process, nor from an adapter that has held them, nor the same bytes again.
    """

    def __init__(self) -> None:
        self.late = 0
        """Packets that were dropped for their age."""
        self.repeated = 0
        """Packets that were dropped because their time does not go on."""
        self._offset_ns = 0
        """Robot's time minus the scanner's, at the earliest arrival."""
        self._begun_ns = -_OFTEN_NS
        self._settles_ns = _SETTLES_NS
        self._heard: tuple[int, int] | None = None  # ms and robot's ns of the newest packet

    def measured_ns(self, ms: int, now_ns: int) -> int | None:
        """Return the robot's time at which a packet was measured; None: it must not count. `now_ns`: robot's time."""
        heard, self._heard = self._heard, (ms, now_ns)
        offset_ns = now_ns - ms * 1_000_000
        if heard is None or now_ns - heard[1] > _LOST_NS:
            self._begin(offset_ns, now_ns)
            return None
        late_ns = (offset_ns - self._offset_ns + _WRAPS_NS // 2) % _WRAPS_NS - _WRAPS_NS // 2
        step_ms = (ms - heard[0]) % WRAPS_MS
        is_repeated = step_ms == 0 or step_ms > WRAPS_MS // 2
        self.repeated += is_repeated
        if is_repeated or late_ns < -LATE_NS or (late_ns > LATE_NS and step_ms * 1_000_000 > LATE_NS):
            self._begin(offset_ns, now_ns)  # or another start of the scanner
            return None
        if late_ns > LATE_NS:
            self.late += 1
            return None
        self._offset_ns += min(late_ns, (now_ns - heard[1]) // _SLOWER)
        is_settled = now_ns - self._begun_ns >= self._settles_ns
        return now_ns - max(0, late_ns) - _PATH_NS if is_settled else None

    def _begin(self, offset_ns: int, now_ns: int) -> None:
        is_often = now_ns - self._begun_ns < _OFTEN_NS
        self._settles_ns = min(2 * self._settles_ns, _SETTLES_AT_MOST_NS) if is_often else _SETTLES_NS
        self._offset_ns, self._begun_ns = offset_ns, now_ns
