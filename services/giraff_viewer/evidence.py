"""Content of each sensor's samples, and whether the robot may go there. No clock: the time comes in."""

from typing import Any, Final, Literal, NamedTuple

from giraff_core.robot import RobotConfig
from giraff_core.senses import Evidence, Summary
from giraff_schemas.messages import GuardState
from giraff_schemas.topics import Topic

EvidenceState = Literal["free", "near", "blocked", "doubted", "fault"]

NEAR: Final = 1.0  # m; something nearer than this is worth a look
_COUNTS_FOR: Final = 0.5  # s; guard no longer counts on a reading that is older than 0.4 s


class Shown(NamedTuple):
    """Content of the screen about one sensor."""

    state: EvidenceState
    why: str
    """Reason why it cannot be relied on, else what is near it. Empty: nothing is."""
    evidence: Evidence
    """Drawing of it. Of a fault: all the floor that it senses."""


class SensorEvidence:
    """One sensor of any type that the guard listens to. Times are ns of one clock."""

    def __init__(self, name: str, robot: RobotConfig) -> None:
        self._name, self._sense, self._radius = name, robot.sensors[name], robot.footprint_radius
        self._field = Evidence(free=self._sense.field(self._radius))
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
        """Take the guard's judgement of it."""
        self._distrust = str(state.trouble) if (state := guard.sensors.get(self._name)) is not None else ""
        verdicts = (guard.forward, guard.backward, guard.turn_left, guard.turn_right)
        self._blocks = any(each.clearance == "blocked" and each.sensor == self._name for each in verdicts)

    def shown(self, now_ns: int) -> Shown:
        """Return the worst that is known of it."""
        if self._told is None:
            return Shown("fault", "not heard yet", self._field)
        summary, evidence = self._told
        silence = (now_ns - self._told_ns) * 1e-9
        fault = f"silent for {silence:.1f} s" if silence > _COUNTS_FOR else str(summary.trouble)
        if fault or (self._distrust and summary.nearest is not None):
            return Shown("fault", fault or self._distrust, self._field)
        if self._distrust:
            return Shown("doubted", self._distrust, evidence)
        is_near = summary.nearest is not None and summary.nearest <= NEAR
        state: EvidenceState = "blocked" if self._blocks else "near" if is_near else "free"
        return Shown(state, summary.text if is_near else "", evidence)
