"""What a run has measured: by figure and subject, all values in order; and the targets. No I/O here."""

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any, Final, Literal, NamedTuple

STACK_FIGURES: Final = {
    "one way 100 Hz p50": "one way at 100 Hz, p50, µs",
    "one way 100 Hz p90": "one way at 100 Hz, p90, µs",
    "one way 1000 Hz p50": "one way at 1 kHz, p50, µs",
    "one way 1000 Hz p90": "one way at 1 kHz, p90, µs",
    "round trip p50": "round trip, p50, µs",
    "publisher 100 Hz": "publisher's processor time a message at 100 Hz, µs",
    "publisher 1000 Hz": "publisher's processor time a message at 1 kHz, µs",
    "subscriber 100 Hz": "subscriber's processor time a message at 100 Hz, µs",
    "subscriber 1000 Hz": "subscriber's processor time a message at 1 kHz, µs",
    "burst": "burst that waits, delivered a second",
    "burst lost": "burst that waits, lost",
    "memory": "memory of the subscriber, RSS, MiB",
    "memory beside": "memory of a master or daemon beside, RSS, MiB",
    "cold start": "start of both processes to the first sample, ms",
    "serial p50": "serial bytes to frame at 100 Hz, p50, µs",
    "serial processor": "processor time a serial frame at 100 Hz, µs",
}
"""By name, what is compared with bare Zenoh, or with a bare `os.read`."""
SERVICE_FIGURES: Final = {
    "processor": "% of a core",
    "wake-ups": "wake-ups a second",
    "threads": "threads",
    "RSS": "RSS, MiB",
    "PSS": "PSS, MiB",
}
OTHER_FIGURES: Final = {
    "codec": "encode and decode, ns",
    "hand to wheel p50": "hand to wheel, p50, ms",
    "simulation": "processor time of a simulated second, s",
}
BARE: Final = "bare "
"""Begins the name of a process of bare Zenoh with the traffic of a service."""
ROBOT_SIDE: Final = ("base", "ranger", "odometry", "guard")
MEASURED: Final = (*ROBOT_SIDE, "door", "motion", "joystick")
SUM: Final = "robot's side"
"""Name of the sum over `ROBOT_SIDE`."""


class Target(NamedTuple):
    """One bound for a median, or for a ratio to raw."""

    figure: str
    subject: str
    kind: Literal["most", "most of raw", "least of raw"]
    bound: float

    @property
    def words(self) -> str:
        """The target as a table names it."""
        kind, _, base = self.kind.partition(" ")
        return f"{kind} {self.bound:g} {base}".rstrip()


_COMPARED: Final = ("one way 100 Hz p50", "one way 1000 Hz p50", "round trip p50")
TARGETS: Final = (
    *(Target(figure, "node", "most of raw", 1.2) for figure in (*_COMPARED, "publisher 1000 Hz", "subscriber 1000 Hz")),
    Target("burst", "node", "least of raw", 0.5),
    Target("burst lost", "node", "most", 0.0),
    Target("cold start", "node", "most of raw", 3.0),
    Target("processor", SUM, "most", 12.0),
    *(Target("RSS", service, "most", 32.0) for service in MEASURED),
)


class Figures:
    """Values by figure and subject, in the order of rounds."""

    def __init__(self, values: Mapping[str, Mapping[str, Sequence[float]]] | None = None) -> None:
        self.values: dict[str, dict[str, list[float]]] = {}
        for figure, subjects in (values or {}).items():
            self.values[figure] = {subject: [*rounds] for subject, rounds in subjects.items()}

    def add(self, figure: str, subject: str, value: float) -> None:
        self.values.setdefault(figure, {}).setdefault(subject, []).append(value)

    def has(self, figure: str, subject: str) -> bool:
        return subject in self.values.get(figure, {})

    def median(self, figure: str, subject: str) -> float:
        return median(self.values[figure][subject])

    def ratio(self, figure: str, subject: str) -> float | None:
        """Return the median of the ratios to raw of the same moment; None: there is none."""
        raw = self.values[figure].get("raw")
        if raw is None or 0.0 in raw:
            return None
        return median(value / base for value, base in zip(self.values[figure][subject], raw, strict=True))

    def judged(self) -> list[tuple[Target, float, bool]]:
        """Return each target whose figure was measured, with its value and whether that reaches it."""
        found = []
        for target in TARGETS:
            if not self.has(target.figure, target.subject):
                continue
            is_ratio = target.kind != "most"
            value = (
                self.ratio(target.figure, target.subject) if is_ratio else self.median(target.figure, target.subject)
            )
            if value is not None:
                is_reached = value >= target.bound if target.kind == "least of raw" else value <= target.bound
                found.append((target, value, is_reached))
        return found


def as_json(figures: Figures) -> dict[str, Any]:
    """Return medians and all values, as `from_json` reads them."""
    return {
        figure: {
            subject: {"median": _rounded(median(rounds)), "values": [*map(_rounded, rounds)]}
            for subject, rounds in subjects.items()
        }
        for figure, subjects in figures.values.items()
    }


def from_json(found: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> Figures:
    return Figures({figure: {who: row["values"] for who, row in rows.items()} for figure, rows in found.items()})


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")
