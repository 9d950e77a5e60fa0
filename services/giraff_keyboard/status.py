"""What the person at the keyboard is shown: who drives, why the robot does not move, what the guard allows."""

from __future__ import annotations

from typing import Any, Final

from giraff_core.operator import what_stops
from giraff_keyboard.policy import KeyboardPolicy
from giraff_schemas.messages import BaseState, Battery, EStop, GuardState, Sample, Verdict
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, SampleT, Topic

STALE: Final = 1.5
"""s after which what was heard says nothing about now."""
HELP: Final = "arrows or WASD drive   SPACE emergency stop   r release it   c take, neutral   + - speed   Ctrl-C end"


class StatusView:
    """The newest of each kind, as long as it is new, in a few lines."""

    topics: tuple[Topic[Any], ...] = (BASE, GUARD, ESTOP, BATTERY)

    def __init__(self) -> None:
        self._base: tuple[BaseState | None, float] = None, 0.0
        self._guard: tuple[GuardState | None, float] = None, 0.0
        self._estop: tuple[EStop | None, float] = None, 0.0
        self._battery: tuple[Battery | None, float] = None, 0.0

    def take(self, sample: Sample, now: float) -> None:
        match sample:
            case BaseState():
                self._base = sample, now
            case GuardState():
                self._guard = sample, now
            case EStop():
                self._estop = sample, now
            case Battery():
                self._battery = sample, now

    def draw(self, policy: KeyboardPolicy, stop: str, now: float) -> list[str]:
        """What to show. `stop`: what became of an emergency stop, or of its release, asked for here."""
        base, guard = _fresh(self._base, now), _fresh(self._guard, now)
        estop, battery = _fresh(self._estop, now), _fresh(self._battery, now)
        linear, angular = policy.speed
        first = [_driver(policy), _armed(base), f"{linear:.2f} m/s, {angular:.2f} rad/s"]
        if base is not None and base.round_trip is not None:
            first.append(f"round trip {base.round_trip * 1000:.0f} ms")
        if battery is not None:
            first.append(f"battery {battery.voltage:.1f} V")
        why = what_stops(policy.trouble(now), base, guard)
        lines = ["   ".join(first), _verdicts(guard), f"why not: {why}" if why else "the robot obeys"]
        lines += [str(told) for told in (policy.operator.rank_notice, stop) if told]
        if estop is not None and estop.engaged:
            lines.append(f"EMERGENCY STOP, engaged by {estop.by}: {estop.reason}")
        return [*lines, HELP]


def _fresh(heard: tuple[SampleT | None, float], now: float) -> SampleT | None:
    sample, when = heard
    return sample if now - when <= STALE else None


def _driver(policy: KeyboardPolicy) -> str:
    driver = policy.operator.holder
    return f"{driver} drives" if driver else "nobody drives"


def _armed(base: BaseState | None) -> str:
    if base is None:
        return "base not heard"
    return "armed" if base.armed else "not armed"


def _verdicts(guard: GuardState | None) -> str:
    if guard is None:
        return "directions: the guard is not heard"
    ways = {"forward": guard.forward, "backward": guard.backward, "left": guard.turn_left, "right": guard.turn_right}
    return "   ".join(f"{way} {_verdict(verdict)}" for way, verdict in ways.items())


def _verdict(verdict: Verdict) -> str:
    return f"{verdict.freedom} ({verdict.sensor})" if verdict.sensor else verdict.freedom
