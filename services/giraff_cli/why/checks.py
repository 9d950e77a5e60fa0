"""Each link of the chain from hand to wheel: whether it holds, and what to do where it does not."""

from __future__ import annotations

from typing import Final

from giraff_cli.telemetry.describe import START_A_HAND, verdicts
from giraff_cli.why.chain import Link, Scene, several, told
from giraff_cli.why.observation import Heard
from giraff_core.estop import RESET_COMMAND
from giraff_guard.config import GuardConfig
from giraff_schemas.messages import DriveCommand, Range, Verdict
from giraff_schemas.services import HANDS
from giraff_schemas.topics import BASE, BATTERY, GUARD, OPERATOR_CMD_VEL, RANGE, WHEELS

_BUDGET: Final = GuardConfig().operator_budget


def operator(scene: Scene) -> Link:
    """The operator's program and its way to the robot."""
    heard = scene.operator
    if heard is None:
        there = [name for name in HANDS if scene.evidence.alive.get(name)]
        if there:
            return scene.silent("operator", there[0])
        return Link(name="operator", standing="missing", text=f"no operator is heard; {START_A_HAND}")
    command, name = heard.sample, heard.sample.operator
    commands = (each.sample for each in scene.evidence.of(OPERATOR_CMD_VEL))
    same = {each.instance for each in commands if each.operator == name}
    if len(same) > 1:
        return told("operator", "STOPS", heard, several(f"operators called {name}", same))
    if scene.clock is None:
        return told("operator", "waits", heard, f"{name} has no clock of the robot to go by")
    if command.source == "fault" and scene.tilt is None:
        return told("operator", "STOPS", heard, f"{name}: {command.reason}")
    if command.tick is None:
        return told(
            "operator", "STOPS", heard, f"{name} does not hear the robot, which is heard here; check its network"
        )
    return _asked(scene, heard)


def _asked(scene: Scene, heard: Heard[DriveCommand]) -> Link:
    command, age = heard.sample, scene.evidence.age(heard, heard.sample.tick)
    asks = "nothing" if command.neutral else f"{command.linear_x:z.2f} m/s, {command.angular_z:z.2f} rad/s"
    text = f"{command.operator} asks for {asks}, {age * 1000.0:.0f} ms old"
    if age > _BUDGET:
        return told("operator", "STOPS", heard, f"{text}: too old; bring it nearer, or check its link")
    if age > _BUDGET / 2.0:
        return told("operator", "limits", heard, f"{text}: slowed; bring it nearer, or check its link")
    return told("operator", "ok", heard, text)


def hand(scene: Scene) -> Link:
    """The tilt sensor in the hand, and how it is held."""
    operator, tilt = scene.operator, scene.tilt
    if operator is None:
        return Link(name="hand", standing="waits", text="no operator's program passes it on")
    if tilt is None:
        return told("hand", "ok", operator, f"at the {operator.sample.operator}")
    sample, command = tilt.sample, operator.sample
    if sample.status != "running":
        return told("hand", "STOPS", tilt, command.reason or f"the tilt sensor is in state {sample.status}")
    if command.source == "fault":
        excused = scene.clock is None or scene.broken("operator")
        return told("hand", "waits" if excused else "STOPS", tilt, command.reason)
    posture = "level" if command.neutral else "tilted"
    return told("hand", "ok", tilt, f"{posture}: {sample.x:z.1f} forward, {sample.y:z.1f} left, of 9.8 m/s²")


def estop(scene: Scene) -> Link:
    """Base's latch."""
    heard = scene.estop
    if heard is None:
        return Link(name="e-stop", standing="waits", text="base, which keeps it, is not heard")
    state = heard.sample
    if not state.engaged:
        return told("e-stop", "ok", heard, "released")
    way_out = "" if RESET_COMMAND in state.reason else f"; {RESET_COMMAND}"
    text = f"engaged by {state.by or 'nobody known'}: {state.reason}{way_out}, and hold the hand level"
    return told("e-stop", "STOPS", heard, text)


def lease(scene: Scene) -> Link:
    """Whom the guard obeys."""
    heard = scene.lease
    if heard is None:
        return Link(name="lease", standing="waits", text="the guard, which gives it, is not heard")
    state = heard.sample
    if scene.operator is not None and state.holder == scene.operator.sample.instance:
        return told("lease", "ok", heard, f"held by {state.operator}")
    if state.holder:
        text = f"held by {state.operator}, who is not heard here; {state.reason}"
    else:
        text = f"nobody holds it; {state.reason or 'tilt the hand to ask for it'}"
    # Asking for it is the last thing to do, once nothing is broken.
    excused = scene.clock is None or scene.broken("operator", "hand", "e-stop", "board")
    excused = excused or (scene.broken("guard") and not scene.blocked)
    return told("lease", "waits" if excused else "STOPS", heard, text)


def ranger(scene: Scene) -> Link:
    """The ultrasonic sensors. One that is blind stops what relies on it, and limits the rest."""
    readings = {heard.sample.sensor: heard for heard in reversed(scene.evidence.of(RANGE))}
    if not readings:
        if scene.evidence.alive.get("ranger"):
            return scene.silent("ranger", "ranger")
        how = "start it on the machine that the ranger board is plugged into"
        return Link(name="ranger", standing="missing", text=f"giraff_ranger is not running, or hangs; {how}")
    newest = min(readings.values(), key=lambda heard: heard.age)
    known = scene.guard.sample.sensors.keys() if scene.guard is not None else readings.keys()
    blind = dict.fromkeys(known - readings.keys(), "not heard; check giraff_ranger")
    blind |= {name: heard.sample.reason for name, heard in readings.items() if heard.sample.state == "fault"}
    if not blind:
        return told("ranger", "ok", newest, ", ".join(_distance(heard.sample) for _, heard in sorted(readings.items())))
    stops = any(verdict.sensor in blind for _, verdict in scene.blocked)
    text = "; ".join(f"{name}: {why}" for name, why in sorted(blind.items()))
    return told("ranger", "STOPS" if stops else "limits", newest, text)


def guard(scene: Scene) -> Link:
    """What may be driven now."""
    heard = scene.guard
    trouble = scene.process("guard", GUARD, "start it on base's machine")
    if heard is None or trouble is not None:
        return trouble or scene.silent("guard", "guard")
    state = heard.sample
    if scene.clock is None:
        return told("guard", "waits", heard, state.reason or "base, whose clock it goes by, is not heard")
    if blocked := scene.blocked:
        text = "; ".join(_judged(way, verdict) for way, verdict in blocked)
        return told("guard", "waits" if scene.broken("ranger") else "STOPS", heard, text)
    limits = [_judged(way, verdict) for way, verdict in verdicts(state) if verdict.freedom in ("blocked", "creep")]
    limits += [f"{sensor} is not trusted: {why}" for sensor, why in state.sensors.items() if why]
    if limits:
        return told("guard", "limits", heard, "; ".join(limits))
    return told("guard", "ok", heard, state.reason or "no direction is blocked")


def board(scene: Scene) -> Link:
    """The base board, as base sees it."""
    heard = scene.base
    if heard is None:
        return Link(name="board", standing="waits", text="base, which talks to it, is not heard")
    state, reason = heard.sample.board, heard.sample.reason
    if not state.connected:
        return told("board", "STOPS", heard, scene.evidence.faults("base") or reason)
    if state.latch != "none":
        text = f"latched: {state.latch}; to release it: {RESET_COMMAND}"
        return told("board", "waits" if scene.broken("e-stop") else "STOPS", heard, text)
    if state.drive_state == "not_configured":
        return told("board", "STOPS", heard, reason)
    return told("board", "ok", heard, f"{state.drive_state}, {state.line_errors} line errors")


def base(scene: Scene) -> Link:
    """Base, and whether a level hand has armed it."""
    heard = scene.base
    trouble = scene.process("base", BASE, "start it on the machine that the base board is plugged into")
    if heard is None or trouble is not None:
        return trouble or scene.silent("base", "base")
    state, battery = heard.sample, scene.evidence.newest(BATTERY)
    if scene.clock is None:
        return told("base", "STOPS", heard, "it gives no clock; restart giraff_base")
    power = f", battery {battery.sample.voltage:.1f} V" if battery is not None else ""
    excused = scene.broken("operator", "hand", "lease", "ranger", "guard", "e-stop", "board")
    if not state.armed or (state.reason and scene.wants_to_move and not state.driving):
        return told("base", "waits" if excused else "STOPS", heard, state.reason or "not armed; hold the hand level")
    if state.reason and state.driving:
        return told("base", "limits", heard, state.reason + power)
    return told("base", "ok", heard, ("drives" if state.driving else "armed") + power)


def wheels(scene: Scene) -> Link:
    """What the wheels do."""
    heard = scene.evidence.newest(WHEELS)
    if heard is None:
        if scene.broken("base", "board") or scene.base is None:
            return Link(name="wheels", standing="waits", text="the base board, which counts them, is not heard")
        return Link(name="wheels", standing="STOPS", text="base tells nothing of them; restart giraff_base")
    state = heard.sample
    speeds = f"{state.left_velocity:z.2f} and {state.right_velocity:z.2f} m/s"
    return told("wheels", "ok", heard, f"{speeds} at levels {state.left_pwm_counts} and {state.right_pwm_counts}")


def _judged(way: str, verdict: Verdict) -> str:
    held = "blocked" if verdict.allowed == 0.0 else "only creeps"
    seen = verdict.reason.removeprefix(f"{verdict.sensor} sees something ")
    why = f": {verdict.reason}" if seen == verdict.reason else f" by range_{verdict.sensor} {seen}"
    return f"{way} {held}{why}" + (f"; {verdict.way_out}" if verdict.way_out else "")


def _distance(reading: Range) -> str:
    return f"{reading.sensor} {reading.state if reading.range is None else f'{reading.range:.2f} m'}"
