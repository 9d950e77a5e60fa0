"""Each link of the chain from hand to wheel: whether it holds, and what to do where it does not."""

from typing import Final

import msgspec

from giraff_cli.why.chain import ChainState, Link, link_from, several
from giraff_core.latest import Latest
from giraff_core.lease import IDLE
from giraff_core.senses import PUBLISHERS
from giraff_core.senses.heard import HeardSensor, heard_sensors
from giraff_guard.config import GuardConfig
from giraff_schemas.messages import DirectionLimit, DriveCommand
from giraff_schemas.services import HANDS, ROS2
from giraff_schemas.topics import ATTITUDE, BASE, BATTERY, GUARD, OPERATOR_CMD_VEL, WHEELS
from giraff_schemas.trouble import Trouble
from giraff_telemetry.describe import START_A_HAND, battery_text, posture_text, verdicts

SENSING: Final = tuple(dict.fromkeys(PUBLISHERS.values()))
"""Services that tell what the robot's sensors say. Each is a link."""
_BUDGET: Final = GuardConfig().operator_budget
_NOT_ARMED: Final = Trouble("not armed", action="hold_level")
_NOT_ASKED: Final = Trouble("nobody holds it", action="ask")
_LATCHED: Final = Trouble("the board has latched", action="release")


def operator(chain: ChainState) -> Link:
    """The operator's program and its way to the robot."""
    heard = chain.operator
    if heard is None:
        there = [name for name in HANDS if name in chain.observation.alive]
        if there:
            return chain.silent("operator", there[0])
        if ROS2.name in chain.observation.alive:
            text = f"no program of ROS publishes cmd_vel, where giraff_ros2 listens; start one, or {START_A_HAND}"
            return Link(name="operator", status="missing", text=_told_of_ros(chain) or text)
        return Link(name="operator", status="missing", text=f"no operator is heard; {START_A_HAND}")
    command, name = heard.sample, heard.sample.operator
    commands = (each.sample for each in chain.observation.of(OPERATOR_CMD_VEL))
    same = {each.instance for each in commands if each.operator == name}
    if len(same) > 1:
        return link_from("operator", "STOPS", heard, several(f"operators called {name}", same))
    if chain.clock is None:
        return link_from("operator", "waits", heard, f"{name} has no clock of the robot to go by")
    if command.source == "fault" and chain.tilt is None:
        return link_from("operator", "STOPS", heard, chain.tell("operator", command.reason.of(name)))
    if command.tick is None:
        return link_from(
            "operator", "STOPS", heard, f"{name} does not hear the robot, which is heard here; check its network"
        )
    return _asked(chain, heard)


def _asked(chain: ChainState, heard: Latest[DriveCommand]) -> Link:
    command, age = heard.sample, chain.observation.age(heard, heard.sample.tick)
    asks = "nothing" if command.neutral else f"{command.linear_x:z.2f} m/s, {command.angular_z:z.2f} rad/s"
    text = f"{command.operator} asks for {asks}, {age * 1000.0:.0f} ms old"
    if age > _BUDGET:
        return link_from("operator", "STOPS", heard, f"{text}: too old; bring it nearer, or check its link")
    if age > _BUDGET / 2.0:
        return link_from("operator", "limits", heard, f"{text}: slowed; bring it nearer, or check its link")
    if command.neutral and command.operator != ROS2.name and (told := _told_of_ros(chain)):
        return link_from("operator", "limits", heard, f"{text}; {told}")
    return link_from("operator", "ok", heard, text)


def _told_of_ros(chain: ChainState) -> str:
    """Return why programs of ROS that ask to drive count for nothing; empty: nothing is wrong with them."""
    told = chain.tell("operator", *chain.observation.faults(ROS2.name))
    return f"giraff_ros2: {told}" if told else ""


def hand(chain: ChainState) -> Link:
    """The tilt sensor in the hand, and how it is held."""
    operator, tilt = chain.operator, chain.tilt
    if operator is None:
        return Link(name="hand", status="waits", text="no operator's program passes it on")
    if tilt is None:
        return link_from("hand", "ok", operator, f"at the {operator.sample.operator}")
    sample, command = tilt.sample, operator.sample
    if sample.status != "running":
        text = chain.tell("hand", command.reason) or f"the tilt sensor is in state {sample.status}"
        return link_from("hand", "STOPS", tilt, text)
    if command.source == "fault":
        excused = chain.clock is None or chain.broken("operator")
        return link_from("hand", "waits" if excused else "STOPS", tilt, chain.tell("hand", command.reason))
    posture = "level" if command.neutral else "tilted"
    return link_from("hand", "ok", tilt, f"{posture}: {sample.x:z.1f} forward, {sample.y:z.1f} left, of 9.8 m/s²")


def estop(chain: ChainState) -> Link:
    """Base's latch."""
    heard = chain.estop
    if heard is None:
        return Link(name="e-stop", status="waits", text="base, which keeps it, is not heard")
    state = heard.sample
    if not state.engaged:
        return link_from("e-stop", "ok", heard, "released")
    why = chain.tell("e-stop", state.reason.of(f"engaged by {state.by or 'nobody known'}"))
    return link_from("e-stop", "STOPS", heard, f"{why}, then {_NOT_ARMED.to_do(chain.words)}")


def lease(chain: ChainState) -> Link:
    """Whom the guard obeys."""
    heard = chain.lease
    if heard is None:
        return Link(name="lease", status="waits", text="the guard, which gives it, is not heard")
    state = heard.sample
    if chain.operator is not None and state.holder == chain.operator.sample.instance:
        return link_from("lease", "ok", heard, f"held by {state.operator}")
    if not state.holder and state.reason == IDLE and not chain.wants_to_move:
        return link_from("lease", "idle", heard, chain.tell("lease", state.reason))
    if state.holder:
        text = f"held by {state.operator}, who is not heard here; {chain.tell('lease', state.reason)}"
    else:
        text = f"nobody holds it; {chain.tell('lease', state.reason) or _NOT_ASKED.to_do(chain.words)}"
    # Asking for it is the last thing to do, once nothing is broken.
    excused = chain.clock is None or chain.broken("operator", "hand", "e-stop", "board")
    excused = excused or (chain.broken("guard") and not chain.blocked)
    return link_from("lease", "waits" if excused else "STOPS", heard, text)


def sensors(service: str, chain: ChainState) -> Link:
    """The sensors that `service` reads. One that is blind stops what relies on it, and limits the rest."""
    known = {} if chain.guard is None else chain.guard.sample.sensor_types
    found = sorted(heard_sensors(known, chain.observation.of).items())
    theirs = {name: each for name, each in found if PUBLISHERS.get(each.sense.type_name()) == service}
    heard = [each.newest for each in theirs.values() if each.newest is not None]
    if not heard:
        return _unheard(service, theirs, chain)
    blind, said = {}, {name: each.summary for name, each in theirs.items()}
    for name, summary in said.items():
        if summary is None:
            blind[name] = f"not heard; check giraff_{service}"
        elif summary.trouble:
            blind[name] = chain.tell(service, summary.trouble)
    newest = min(heard, key=lambda each: each.age)
    if not blind:
        text = ", ".join(f"{name} {summary.text}" for name, summary in said.items() if summary is not None)
        return link_from(service, "ok", newest, text)
    stops = any(verdict.sensor in blind for _, verdict in chain.blocked)
    lines = [f"{name}: {why}" for name, why in blind.items()]
    if None in said.values():  # which its service may know a cause of
        lines += [chain.tell(service, own) for own in chain.observation.faults(service) if not chain.is_told(own)]
    return link_from(service, "STOPS" if stops else "limits", newest, "; ".join(lines))


def _unheard(service: str, theirs: dict[str, HeardSensor], chain: ChainState) -> Link:
    if chain.guard is None:
        return Link(name=service, status="waits", text="the guard, which knows the sensors, is not heard")
    if not theirs:
        return link_from(service, "ok", chain.guard, "the robot file has no sensor that it reads")
    if service in chain.observation.alive:
        return chain.silent(service, service)
    how = "start it on the machine that what it reads is plugged into"
    return Link(name=service, status="missing", text=f"giraff_{service} is not running, or hangs; {how}")


def guard(chain: ChainState) -> Link:
    """What may be driven now."""
    heard = chain.guard
    trouble = chain.process("guard", GUARD, "start it on base's machine")
    if heard is None or trouble is not None:
        return trouble or chain.silent("guard", "guard")
    state = heard.sample
    if chain.clock is None:
        text = chain.tell("guard", state.reason) or "base, whose clock it goes by, is not heard"
        return link_from("guard", "waits", heard, text)
    if blocked := chain.blocked:
        text = chain.tell("guard", *(_judged(way, verdict) for way, verdict in blocked))
        return link_from("guard", "waits" if chain.broken(*SENSING) else "STOPS", heard, text)
    limits = [_judged(way, verdict) for way, verdict in verdicts(state) if verdict.clearance in ("blocked", "creep")]
    limits += [each.trouble.of(f"{name} is not trusted") for name, each in state.sensors.items() if each.trouble]
    is_told = chain.lease is not None and state.reason == chain.lease.sample.reason
    own = () if is_told or not state.reason or state.reason in limits else (state.reason,)
    if limits:
        return link_from("guard", "limits", heard, chain.tell("guard", *own, *limits))
    return link_from("guard", "ok", heard, chain.tell("guard", *own) or "no direction is blocked")


def board(chain: ChainState) -> Link:
    """The base board, as base sees it."""
    heard = chain.base
    if heard is None:
        return Link(name="board", status="waits", text="base, which talks to it, is not heard")
    state, reason = heard.sample.board, heard.sample.reason
    if not state.connected:
        return link_from("board", "STOPS", heard, chain.tell("board", *(chain.observation.faults("base") or (reason,))))
    if state.latch != "none":
        if chain.broken("e-stop"):
            return link_from("board", "waits", heard, f"latched: {state.latch}; see e-stop")
        return link_from("board", "STOPS", heard, f"latched: {state.latch}; {_LATCHED.to_do(chain.words)}")
    if state.drive_state in ("not_configured", "held"):
        return link_from("board", "STOPS", heard, chain.tell("board", reason))
    return link_from("board", "ok", heard, f"{state.drive_state}, {state.line_errors} line errors")


def base(chain: ChainState) -> Link:
    """Base, whether a level hand has armed it, and what it notices."""
    link = _armed(chain)
    untold = [each for each in chain.observation.faults("base") if not chain.is_told(each)]
    if not (untold := [each for each in untold if not chain.is_told(each.of("slowed"))]):
        return link
    status = "limits" if link.status == "ok" else link.status
    return msgspec.structs.replace(link, status=status, text=f"{link.text}; {chain.tell('base', *untold)}")


def _armed(chain: ChainState) -> Link:
    heard = chain.base
    trouble = chain.process("base", BASE, "start it on the machine that the base board is plugged into")
    if heard is None or trouble is not None:
        return trouble or chain.silent("base", "base")
    state, battery = heard.sample, chain.observation.newest(BATTERY)
    if chain.clock is None:
        return link_from("base", "STOPS", heard, "it gives no clock; restart giraff_base")
    power = f", battery {battery_text(battery.sample)}" if battery is not None else ""
    excused = chain.broken("operator", "hand", "lease", *SENSING, "guard", "e-stop", "board")
    reason = "see e-stop" if chain.broken("e-stop") else chain.tell_once("base", state.reason) or "not armed"
    # A base with a reason of its own forbids to move, whoever asks.
    is_idle = chain.links["lease"].status == "idle" and state.reason == IDLE
    if is_idle and not state.armed and not excused:
        return link_from("base", "idle", heard, reason)
    if not state.armed or (state.reason and chain.wants_to_move and not state.driving):
        if excused:
            return link_from("base", "waits", heard, reason)
        return link_from("base", "STOPS", heard, chain.tell("base", state.reason or _NOT_ARMED))
    if state.reason and state.driving:
        return link_from("base", "limits", heard, f"{chain.tell('base', state.reason)}{power}")
    return link_from("base", "ok", heard, ("drives" if state.driving else "armed") + power)


def wheels(chain: ChainState) -> Link:
    """What the wheels do."""
    heard = chain.observation.newest(WHEELS)
    if heard is None:
        if chain.broken("base", "board") or chain.base is None:
            return Link(name="wheels", status="waits", text="the base board, which counts them, is not heard")
        return Link(name="wheels", status="STOPS", text="base tells nothing of them; restart giraff_base")
    state = heard.sample
    speeds = f"{state.left_velocity:z.2f} and {state.right_velocity:z.2f} m/s"
    counts = f"{state.left_pwm_counts} and {state.right_pwm_counts}"
    if (attitude := chain.observation.newest(ATTITUDE)) is None:
        return link_from("wheels", "ok", heard, f"{speeds} at PWM {counts}")
    text = f"{speeds} at motor commands of {counts} of 255; {posture_text(attitude.sample)}"
    return link_from("wheels", "ok" if attitude.sample.posture == "stands" else "waits", heard, text)


def _judged(way: str, verdict: DirectionLimit) -> Trouble:
    return verdict.reason.of(f"{way} {'blocked' if verdict.allowed == 0.0 else 'only creeps'}")
