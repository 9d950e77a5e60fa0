"""How far a sensor's silence is believed: one that is deaf says what one in the open says."""

from __future__ import annotations

from typing import NamedTuple

from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_guard.motion import Motion
from giraff_schemas.messages import RobotTime


class _Proof(NamedTuple):
    robot_ns: int
    travel: float
    turned: float


class SilenceTrust:
    """Of one sensor."""

    def __init__(self, live: Live[GuardConfig]) -> None:
        self._live = live
        self._proof: _Proof | None = None

    def prove(self, robot_ns: int, motion: Motion) -> None:
        """It heard one surface twice, the last time at `robot_ns`."""
        self._proof = _Proof(robot_ns, motion.travel, motion.turned)

    def doubt(self, motion: Motion, now: RobotTime) -> float:
        """How little its silence is worth by now: 0 as much as an echo, 1 no more than `unproved_linear`."""
        config, proof = self._live.config, self._proof
        if proof is None:
            return 1.0
        way = motion.travel - proof.travel + config.proof_turn * (motion.turned - proof.turned)
        by_way = (way - config.proof_travel) / (config.fade_travel - config.proof_travel)
        since = (now.robot_ns - proof.robot_ns) * 1e-9
        by_time = (since - config.proof_time) / (config.fade_time - config.proof_time)
        return min(1.0, max(0.0, by_way, by_time))
