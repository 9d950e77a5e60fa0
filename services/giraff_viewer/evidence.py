"""Content of each sensor's samples, and whether the robot may go there. No clock: the time comes in."""

from typing import Any, Final, Literal

from giraff_core.senses import Evidence, Sense, Summary
from giraff_schemas.messages import GuardState
from giraff_schemas.topics import Topic

EvidenceState = Literal["free", "near", "blocked", "doubted", "fault"]

NEAR: Final = 1.0  # m; something nearer than this is worth a look
_COUNTS_FOR: Final = 0.5  # s; guard no longer counts on a reading that is older than 0.4 s


class SensorEvidence:
    """One sensor of any type that the guard listens to. Times are ns of one clock."""

    def __init__(self, name: str, sense: Sense, footprint_radius: float) -> None:
        self.name = name
        self._sense, self._radius = sense, footprint_radius
        self._field = Evidence(free=sense.field(footprint_radius))
        self._told: tuple[Summary, Evidence] | None = None
        self._told_ns = 0
        self._distrust = ""
        self._blocks = False

    def on_sample(self, topic: Topic[Any], sample: Any, at_ns: int) -> bool:
        """Take a sample that names this sensor. False: a sensor of another type says it."""
        if topic != self._sense.TOPIC:
            return False
        self._told = self._sense.summary(sample), self._sense.evidence(sample, self._radius)
        self._told_ns = at_ns
        return True

    def judge(self, guard: GuardState) -> None:
        """What the guard makes of it."""
        self._distrust = str(state.trouble) if (state := guard.sensors.get(self.name)) is not None else ""
        verdicts = (guard.forward, guard.backward, guard.turn_left, guard.turn_right)
        self._blocks = any(each.clearance == "blocked" and each.sensor == self.name for each in verdicts)

    def state(self, now_ns: int) -> EvidenceState:
        """The worst that is known of it."""
        if self._told is None or self._silence(now_ns) > _COUNTS_FOR or self._told[0].trouble:
            return "fault"
        nearest = self._told[0].nearest
        if self._distrust:
            return "doubted" if nearest is None else "fault"
        if self._blocks:
            return "blocked"
        return "free" if nearest is None or nearest > NEAR else "near"

    def shown(self, now_ns: int) -> Evidence:
        """Return what is drawn of it: of a fault, all the floor that it senses."""
        return self._field if self._told is None or self.state(now_ns) == "fault" else self._told[1]

    def reason(self, now_ns: int) -> str:
        """Return why it cannot be relied on, else what is near it. Empty: nothing is."""
        if self._told is None:
            return "not heard yet"
        if (silence := self._silence(now_ns)) > _COUNTS_FOR:
            return f"silent for {silence:.1f} s"
        summary = self._told[0]
        is_far = summary.nearest is None or summary.nearest > NEAR
        return str(summary.trouble) or self._distrust or ("" if is_far else summary.text)

    def _silence(self, now_ns: int) -> float:
        return (now_ns - self._told_ns) * 1e-9
