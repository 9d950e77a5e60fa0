"""The two clocks in use beside `time.monotonic` (which paces loops)."""

import time


def robot_now_ns() -> int:
    """Nanoseconds of the clock that ticks are made of and judged by. Meaningful only on base's host.

    CLOCK_BOOTTIME, unlike CLOCK_MONOTONIC, goes on while the machine is suspended: what was queued before a
    suspend is old after it.
    """
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME)
