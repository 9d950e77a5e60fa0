"""A machine and its clocks."""

from typing import Final

from giraff_sim.hosts.disk import Disk
from giraff_sim.hosts.event_queue import EventQueue

_BOOTED_US: Final = 3_600_000_000  # a machine has been up for an hour when the simulation begins
_YEAR_2026_NS: Final = 1_767_225_600_000_000_000  # since 1970


class Host:
    """A machine. Its wall clock is as wrong as it is set; the others count what they count on Linux."""

    def __init__(self, name: str, agenda: EventQueue, booted_us: int = _BOOTED_US) -> None:
        self.name = name
        self.suspended = False
        self.wall_ahead_ns = 0
        """How far its wall clock is ahead of the true time."""
        self.wall_drift = 0.0
        """s that its wall clock gains a second."""
        self.disk = Disk(agenda)
        self._agenda = agenda
        self._booted_us = booted_us
        self._slept_us = 0
        self._fell_asleep_us = 0

    def boottime_ns(self) -> int:
        """CLOCK_BOOTTIME: goes on while the machine is suspended."""
        return (self._booted_us + self._agenda.now_us) * 1000

    def monotonic(self) -> float:
        """CLOCK_MONOTONIC, s: stands still while the machine is suspended."""
        now_us = self._fell_asleep_us if self.suspended else self._agenda.now_us
        return (self._booted_us + now_us - self._slept_us) * 1e-6

    def wall_ns(self) -> int:
        """CLOCK_REALTIME."""
        passed_ns = self._agenda.now_us * 1000
        gained_ns = round(passed_ns * self.wall_drift) if self.wall_drift else 0
        return _YEAR_2026_NS + self.wall_ahead_ns + passed_ns + gained_ns

    def suspend(self) -> None:
        self.suspended = True
        self._fell_asleep_us = self._agenda.now_us

    def resume(self) -> None:
        self._slept_us += self._agenda.now_us - self._fell_asleep_us
        self.suspended = False
