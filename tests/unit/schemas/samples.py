"""Any message of the schemas, for property tests."""

from typing import Any, Literal, get_args, get_origin, get_type_hints

import msgspec
from hypothesis import strategies as st

from giraff_schemas import bumper as b
from giraff_schemas import camera as c
from giraff_schemas import localization as lo
from giraff_schemas import messages as m
from giraff_schemas import motion as mo
from giraff_schemas import places as pl
from giraff_schemas import scan as sc

_FINITE = st.floats(allow_nan=False, allow_infinity=False)
_COUNTS = st.integers(min_value=-(1 << 63), max_value=(1 << 64) - 1)  # what MessagePack can carry
_EPOCHS = st.integers(min_value=1, max_value=(1 << 32) - 1)
_ROBOT_NS = st.integers(min_value=0, max_value=(1 << 64) - 1)
_TEXTS = st.text(max_size=8)
_NAMES = st.sampled_from(("kitchen", "Küche 2", "line-1"))
_NEAR = st.floats(-1000.0, 1000.0)
_INSTANCES = st.text(min_size=1, max_size=8)

_LEAVES: dict[Any, st.SearchStrategy[Any]] = {
    int: _COUNTS,
    float: _FINITE,
    str: _TEXTS,
    bytes: st.binary(max_size=8),
    bool: st.booleans(),
    type(None): st.none(),
    lo.FreeCells: st.binary(max_size=8).map(
        lambda bits: lo.FreeCells(left=-1.0, bottom=2.0, side=0.05, columns=8, rows=len(bits), bits=bits)
    ),
    pl.Place: st.builds(pl.Place, name=_NAMES, x=_NEAR, y=_NEAR, yaw=_FINITE),
    pl.NoGoLine: st.builds(pl.NoGoLine, name=_NAMES, x=_NEAR, y=_NEAR, end_x=st.just(0.5), end_y=st.just(-0.25)),
    m.RobotTime: st.builds(m.RobotTime, epoch=_EPOCHS, robot_ns=_ROBOT_NS),
}


def _values(type_: Any) -> st.SearchStrategy[Any]:
    if type_ in _LEAVES:
        return _LEAVES[type_]
    if isinstance(type_, type) and issubclass(type_, msgspec.Struct):
        return messages(type_)
    arguments = get_args(type_)
    if get_origin(type_) is Literal:
        return st.sampled_from(arguments)
    if get_origin(type_) is dict:
        return st.dictionaries(_TEXTS, _values(arguments[1]), max_size=3)
    if get_origin(type_) is tuple:
        if arguments[-1] is Ellipsis:
            return st.lists(_values(arguments[0]), max_size=3).map(tuple)
        return st.tuples(*map(_values, arguments))
    return st.one_of(*map(_values, arguments))  # a union


def messages(type_: type[msgspec.Struct]) -> st.SearchStrategy[Any]:
    """Messages of `type_` with any values that it may hold."""
    fields = {name: _values(hint) for name, hint in get_type_hints(type_).items()}
    if "instance" in fields:
        fields["instance"] = _INSTANCES
    if type_ is m.Tick:
        fields |= {"epoch": _EPOCHS, "robot_ns": _ROBOT_NS}
    if type_ is m.Range:
        echo = st.fixed_dictionaries(fields | {"state": st.just("echo"), "range": _FINITE})
        none = st.fixed_dictionaries(fields | {"state": st.sampled_from(["clear", "fault"]), "range": st.none()})
        return st.one_of(echo, none).map(lambda values: m.Range(**values))
    if type_ is lo.Particles:
        poses = st.lists(st.tuples(_FINITE, _FINITE, _FINITE), max_size=3)
        others = {name: value for name, value in fields.items() if name not in {"x", "y", "yaw"}}
        return st.builds(_particles, poses, st.fixed_dictionaries(others))
    if type_ is sc.LaserScan:
        seconds, sectors = st.floats(0.0, 0.5), st.lists(st.integers(0, sc.SECTORS - 1), max_size=3).map(tuple)
        rays, steps = st.binary(min_size=2 * sc.RAYS, max_size=2 * sc.RAYS), st.floats(0.001, 3.0)
        fields |= {"ranges": rays, "step": steps, "duration": seconds, "blind": sectors}
    return st.builds(type_, **fields)


def _particles(poses: list[tuple[float, float, float]], fields: dict[str, Any]) -> lo.Particles:
    x, y, yaw = (tuple(pose[axis] for pose in poses) for axis in range(3))
    return lo.Particles(x=x, y=y, yaw=yaw, **fields)


def an_example(type_: type[msgspec.Struct]) -> dict[str, Any]:
    """The plain map of one valid message, for a test to spoil."""
    return dict(_EXAMPLES[type_])


_START = {"seq": 3, "stamp_ns": 1_700_000_000_000_000_000, "instance": "a1"}
_TIME = {"epoch": 7, "robot_ns": 5_000_000_000}
_WELL = {"what": "", "remedy": "", "action": "", "argument": ""}
_VERDICT = {"allowed": 0.6, "clearance": "free", "sensor": "", "reason": _WELL}
_BOARD = {
    "connected": True,
    "boot_id": 4,
    "drive_state": "active",
    "latch": "none",
    "last_refusal": "none",
    "accepted": 10,
    "refused": 0,
    "line_errors": 0,
    "report_ms": 10,
}
_PLACE = {"x": 1.0, "y": 2.0, "yaw": 0.5}
_DISPLACEMENT = {"path": 1.0, "x": 1.0, "y": 0.1, "yaw": 0.2}
_MOTION = _START | {
    "id": 11,
    "by": "a script",
    "stage": "moving",
    "step": 1,
    "steps": 2,
    "asked": _DISPLACEMENT,
    "achieved": _DISPLACEMENT,
    "covariance": [0.0] * 6,
    "elapsed": 1.5,
    "time_limit": 20.0,
    "outcome": "",
    "sensor": "",
    "reason": _WELL,
}
_SAYS = {"reason": {"what": "it is dark", "remedy": "light a fire", "action": "run", "argument": "giraff why"}}
_TWIST = {"linear_x": 0.3, "angular_z": -0.2}

_EXAMPLES: dict[type[msgspec.Struct], dict[str, Any]] = {
    m.Tick: _START | _TIME,
    m.Tilt: _START | {"x": 0.0, "y": 0.0, "z": 9.8, "status": "running", "tick": _TIME},
    m.DriveCommand: _START
    | _TWIST
    | {"operator": "joystick", "lease_counter": 9, "source": "hand", "reason": _WELL, "tick": _TIME},
    c.Picture: _START
    | {"camera": "head", "jpeg": b"\xff\xd8", "width": 320, "height": 240, "tick": _TIME, "exposure": 0.016}
    | {"since_tick": 0.01},
    c.CameraHold: _START
    | {"camera": "head", "to": "c3", "state": 4, "by": "web", "size": "small", "seen": 2, "largest": "full"},
    c.CameraState: _START
    | {
        "camera": "head",
        "askers": [{"instance": "b2", "by": "web", "size": "small", "transfer": 0.02, "is_late": False}],
        "width": 320,
        "height": 240,
        "rate": 15.0,
    }
    | _SAYS,
    c.VisualOdometry: _START
    | {
        "camera": "head",
        "picture": 9,
        "tick": _TIME,
        "since_tick": 0.01,
        "key": 2,
        "motion": [0.02, 0.0, 0.01],
        "covariance": [1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6],
        "wheels": None,
        "path": [1.2, 0.1, 0.3],
        "seen_m": 1.1,
        "blind_m": 0.1,
        "width": 320,
        "height": 240,
        "tracked": [[160, 200]],
        "rejected": [],
        "ground": [[0, 239], [319, 239]],
    }
    | _SAYS,
    m.SerialLine: _START | {"name": "arduino", "text": "23.5 °C", "goes_on": False, "replaced": 0},
    m.SerialWrite: _START | {"name": "arduino", "text": "led on"},
    m.Lease: _START | {"holder": "b2", "operator": "joystick", "counter": 9, "unranked": ["gamepad"]} | _SAYS,
    m.EStop: _START | {"engaged": True, "id": 5, "by": "operator", "engaged_ns": 7, "off": True} | _SAYS,
    m.GuardedCommand: _START
    | _TWIST
    | {
        "guard_tick": _TIME,
        "operator": "b2",
        "lease_counter": 9,
        "operator_tick": _TIME,
        "range_tick": None,
        "source": "hand",
        "faults": 0,
        "hand_neutral": False,
        "reason": _WELL,
        "free_side": "backward",
        "heard": [4, -1, 7, 3, 3, 5],
        "decided_us": 15700,
    },
    m.Range: _START | {"sensor": "rear", "state": "echo", "range": 1.25, "echo_us": 7250, "tick": _TIME} | _SAYS,
    sc.LaserScan: _START
    | {"sensor": "laser", "ranges": bytes(2 * sc.RAYS), "bearing": 0.0, "step": -0.014, "duration": 0.1}
    | {"since_tick": 0.02, "odom": [0.5, -0.25, 0.125], "blind": [3, 4], "trouble": _WELL, "tick": _TIME},
    b.Bump: _START | {"sensor": "front", "pressed": True, "tick": _TIME},
    m.Wheels: _START
    | {
        "left_ticks": -5,
        "right_ticks": 5,
        "left_velocity": -0.1,
        "right_velocity": 0.1,
        "left_pwm_counts": -12,
        "right_pwm_counts": 12,
        "board_us": 123,
        "boot_id": 4,
        "tick": _TIME,
    },
    m.Attitude: _START
    | {
        "lean": 0.02,
        "rate": -0.1,
        "accelerometer_lean": 0.03,
        "trim": 0.01,
        "torque": -12.5,
        "posture": "sits down",
        "cause": "the battery was low",
        "tick": _TIME,
        "pivot": 0.175,
    },
    m.Odometry: _START
    | _TWIST
    | {
        "x": 1.0,
        "y": 2.0,
        "yaw": 0.5,
        "covariance": [0.0] * 6,
        "path": 3.0,
        "board_us": 123,
        "boot_id": 4,
        "tick": _TIME,
        "jumps": 2,
        "breaks": 1,
    },
    m.TruePose: _START | {"x": 1.0, "y": 2.0, "yaw": 0.5, "tick": _TIME, "walls": [[[0.0, 0.0], [5.0, 0.0]]]},
    m.BaseState: _START
    | {
        "armed": True,
        "driving": False,
        "reason": _WELL,
        "guard": "c3",
        "round_trip": 0.03,
        "budget_left": 0.17,
        "board": _BOARD,
    },
    m.Battery: _START | {"voltage": 25.1, "since_charge": 5400.0},
    m.GuardState: _START
    | {
        "forward": _VERDICT,
        "backward": _VERDICT,
        "turn_left": _VERDICT,
        "turn_right": _VERDICT,
        "operator": "b2",
        "reason": _WELL,
        "sensors": {"rear": {"type": "hc-sr04", "trouble": _WELL}},
    },
    lo.MapPose: _START
    | {
        "state": "ambiguous",
        "x": 1.0,
        "y": 2.0,
        "yaw": 0.5,
        "covariance": [0.0] * 6,
        "odom": _PLACE,
        "candidates": [_PLACE | {"belief": 0.6}],
        "explained": 0.9,
        "way": 3.0,
        "particles": 1000,
        "map": "hall",
        "reason": _WELL | {"what": "2 places fit"},
        "tick": _TIME,
    },
    lo.Particles: _START | {"x": [1.0, 2.0], "y": [0.0, 1.0], "yaw": [0.5, -0.5]},
    lo.MapWalls: _START
    | {
        "map": "hall",
        "walls": [[0.0, 0.0, 5.0, 0.0]],
        "free": {"left": 0.0, "bottom": 0.0, "side": 0.05, "columns": 3, "rows": 3, "bits": b"\x00\x80"},
    },
    pl.Places: _START
    | {
        "map": "hall",
        "places": [_PLACE | {"name": "kitchen"}],
        "no_go": [{"name": "line-1", "x": 0.0, "y": 1.0, "end_x": 2.0, "end_y": 1.0}],
        "reason": _WELL,
    },
    mo.MotionHold: _START | {"id": 11, "tick": _TIME},
    mo.MotionState: _MOTION,
    pl.RouteState: _MOTION
    | {
        "place": "kitchen",
        "goal": {"x": 1.0, "y": 2.0, "yaw": 0.5},
        "corners": [[0.0, 0.0], [1.0, 2.0]],
        "at": [0.5, 1.0],
    },
}
