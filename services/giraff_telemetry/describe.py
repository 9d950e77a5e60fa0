"""The state of a robot's parts in a word or two, for any screen."""

import math
from typing import Final, NamedTuple

from giraff_core.latest import Latest
from giraff_core.motion.result import spot_of, way_of
from giraff_core.senses.heard import HeardSensor
from giraff_schemas.camera import CameraState
from giraff_schemas.messages import Attitude, Battery, DirectionLimit, GuardState
from giraff_schemas.places import RouteState
from giraff_schemas.services import HANDS
from giraff_telemetry.collector import Snapshot
from giraff_telemetry.localization import short_pose_text

START_A_HAND: Final = f"start {' or '.join(f'giraff_{hand}' for hand in HANDS)} on the operator's machine"
DIRECTIONS: Final = ("forward", "backward", "turn left", "turn right")


class Moving(NamedTuple):
    """What the robot does now. None: nothing tells."""

    path: float | None
    """m travelled, as odometry last had it."""
    speed: float | None
    """m/s."""
    turn: float | None
    """rad/s."""


def moving(snapshot: Snapshot) -> Moving:
    """As odometry has it; while that is silent, the wheels tell the speed. An old speed is none."""
    odometry, wheels = snapshot.odometry, snapshot.wheels
    path = None if odometry is None else odometry.sample.path
    if odometry is not None and odometry.fresh:
        return Moving(path, odometry.sample.linear_x, odometry.sample.angular_z)
    if wheels is not None and wheels.fresh:
        return Moving(path, (wheels.sample.left_velocity + wheels.sample.right_velocity) / 2.0, None)
    return Moving(path, None, None)


def sensor_text(sensor: HeardSensor) -> str:
    """Return what a sensor says, in a word."""
    return "silent" if sensor.summary is None else sensor.summary.text


def sensors_text(snapshot: Snapshot) -> str:
    """Return what all sensors say, in a row."""
    return "ranges " + " ".join(f"{sensor_text(sensor):>6}" for sensor in snapshot.sensed.values())


def battery_text(battery: Battery) -> str:
    """Return the battery's volts, and how long ago it was charged, where base has seen it."""
    volts, since = f"{battery.voltage:.1f} V", battery.since_charge
    return volts if since is None else f"{volts}, charged {since / 3600.0:.1f} h ago"


def base_text(snapshot: Snapshot) -> str:
    """What base does, in a word or two."""
    base, estop = snapshot.base, snapshot.estop
    if base is None or not base.fresh:
        return "silent"
    if estop is not None and estop.sample.engaged:
        return "EMERGENCY STOP"
    if base.sample.board.latch not in ("", "none"):
        return f"latched, {base.sample.board.latch.replace('_', ' ')}"
    if not base.sample.armed:
        return "not armed"
    return "driving" if base.sample.driving else "armed, at rest"


def forward_text(seen: Latest[GuardState] | None) -> str:
    """What the guard allows forward."""
    if seen is None or not seen.fresh:
        return "unknown"
    verdict = seen.sample.forward
    return verdict.clearance if not verdict.sensor else f"{verdict.clearance} ({verdict.sensor})"


def verdicts(state: GuardState) -> list[tuple[str, DirectionLimit]]:
    """By direction."""
    return list(zip(DIRECTIONS, (state.forward, state.backward, state.turn_left, state.turn_right), strict=True))


def limit_text(snapshot: Snapshot) -> str:
    """What limits the robot now, with the way out: what it is asked for first; empty: nothing does."""
    guard = snapshot.guard
    said = base_reason(snapshot)
    if said or guard is None or not guard.fresh:
        return said
    if guard.sample.reason:
        return str(guard.sample.reason)
    for label, verdict in verdicts(guard.sample):
        if verdict.clearance != "free":
            return f"{label} {verdict.clearance}: {verdict.reason}"
    return ""


def holder_text(snapshot: Snapshot) -> str:
    """Whom the guard obeys; empty: that is not known."""
    lease = snapshot.lease
    return "" if lease is None or not lease.fresh else lease.sample.operator or "nobody"


def base_reason(snapshot: Snapshot) -> str:
    """Why base does not do what is asked; empty when it does."""
    base = snapshot.base
    if base is None:
        return ""
    return str(base.sample.reason) if base.fresh else f"not heard for {base.age:.0f} s"


def localization_text(snapshot: Snapshot) -> str:
    """Where it is on the map, and how sure that is; empty: nothing ever told."""
    seen = snapshot.localization
    if seen is None:
        return ""
    return short_pose_text(seen.sample) if seen.fresh else f"not heard for {seen.age:.0f} s"


def route_text(snapshot: Snapshot) -> str:
    """Return how a route goes on, or has ended just now. Empty: there is none."""
    seen = snapshot.route
    if seen is None:
        return ""
    return state_text(seen.sample) if seen.fresh else f"not heard for {seen.age:.0f} s"


def state_text(route: RouteState) -> str:
    """Return a route's goal and way, and the cause and place of a wait or of an end."""
    word = {"moving": "", "waiting": "waits", "ended": route.outcome.replace("_", " ")}.get(route.stage, route.stage)
    leg = f"leg {route.step} of {route.steps}" if route.step and route.outcome != "arrived" else ""
    what = " in ".join(filter(None, (word, leg)))
    text = ", ".join(filter(None, (f"to {route.place or 'a point'}", what, way_of(route))))
    text += f": {route.reason}" if route.reason else ""
    return f"{text} ({spot})" if (spot := spot_of(route)) else text


def balance_text(snapshot: Snapshot) -> str:
    """Return how a robot that balances holds itself. Empty: it is none, or nothing has told it."""
    seen = snapshot.attitude
    if seen is None:
        return ""
    return posture_text(seen.sample) if seen.fresh else f"not heard for {seen.age:.0f} s"


def posture_text(attitude: Attitude) -> str:
    """Return posture, lean and torque, and the cause where it does not stand."""
    why = f", because {attitude.cause}" if attitude.cause and attitude.posture != "stands" else ""
    return f"{attitude.posture}{why}: leans {math.degrees(attitude.lean):z.1f}°, {attitude.torque:z.0f} N m"


def seen_text(state: CameraState) -> str:
    """Return who sees what a camera sees. Empty: nobody does, and it sends nothing."""
    return f"camera {state.camera} is seen by {', '.join(asker.by for asker in state.askers)}" if state.askers else ""


def cameras_text(snapshot: Snapshot) -> str:
    """Return which cameras are on, and who looks. Empty: none is."""
    texts = (seen_text(seen.sample) for seen in snapshot.cameras.values() if seen.fresh)
    return "; ".join(text for text in texts if text)


def estop_text(snapshot: Snapshot) -> str:
    """The emergency stop, by whom and why; empty: that is not known."""
    estop = snapshot.estop
    if estop is None or not estop.fresh:
        return ""
    state = estop.sample
    return f"engaged by {state.by or 'nobody known'}: {state.reason}" if state.engaged else "released"
