"""The topics table: the only place where a key is written.

Keys are under `giraff/<robot>/`. `*` in a key stands for one chunk (an operator's or a sensor's name), given with `at`.
"""

from typing import Any, Generic, Literal, TypeVar

import msgspec

from giraff_schemas import camera as c
from giraff_schemas import localization as lo
from giraff_schemas import messages as m
from giraff_schemas import motion as mo
from giraff_schemas import params as p
from giraff_schemas import places as pl
from giraff_schemas import requests as r
from giraff_schemas.bumper import Bump
from giraff_schemas.scan import LaserScan

SampleT = TypeVar("SampleT", bound=m.Sample)

Qos = Literal["control", "state", "bulk"]
"""`control`: real-time priority, sent at once. `state`: below it. `bulk`: last, in a session of its own.
All drop rather than wait: an old one is useless."""

ROOT = "giraff"
LONGEST_CHUNK = 80
"""Characters of one name in a key. The simulation of a host is called by the host, whose name has at most 64."""

RequestT = TypeVar("RequestT", bound=msgspec.Struct)
AnswerT = TypeVar("AnswerT", bound=msgspec.Struct)


class Topic(msgspec.Struct, Generic[SampleT], frozen=True):
    """One row of the table. `rate_hz` is the nominal rate; 0 = on change only."""

    key: str
    schema: type[SampleT]
    rate_hz: float
    qos: Qos
    names: str = ""
    """Field of the sample that says what `*` stands for, and must agree with it: access is granted by key."""
    inside: bool = False
    """Services inside act on it, or it proves a stop: they take it from the robot's own host only."""
    size: int = 300
    """bytes. Usual size of a large sample. The flight recorder shares its memory by rate and size."""

    def name_in(self, key: str) -> str:
        """The operator, sensor or camera that a key of this row is of: the chunk after its first one."""
        return key.split("/")[-self.key.count("/")]

    def at(self, name: str) -> "Topic[SampleT]":
        """The row of one operator or sensor."""
        require_chunk(name)
        return msgspec.structs.replace(self, key=self.key.replace("*", name))


class Query(msgspec.Struct, Generic[RequestT, AnswerT], frozen=True):
    """One row of the table of queries: a request that one service answers."""

    key: str
    request: type[RequestT]
    answer: type[AnswerT]
    unreadable: RequestT | None = None
    """Request that one which cannot be read stands for. None: it is refused."""

    def at(self, service: str) -> "Query[RequestT, AnswerT]":
        """The row of one service."""
        require_chunk(service)
        return msgspec.structs.replace(self, key=self.key.replace("*", service))


TICK = Topic("tick", m.Tick, 50, "control", inside=True)
TILT = Topic("tilt", m.Tilt, 50, "state")
OPERATOR_CMD_VEL = Topic("cmd_vel/*", m.DriveCommand, 50, "control", "operator")
LEASE = Topic("lease", m.Lease, 10, "control")
RANGE = Topic("range/*", m.Range, 1000 / 60 / 3, "control", "sensor", inside=True)
BUMPER = Topic("bumper/*", Bump, 20, "control", "sensor", inside=True)
SCAN = Topic("scan/*", LaserScan, 10, "control", "sensor", inside=True, size=1100)
CMD_VEL = Topic("cmd_vel", m.GuardedCommand, 50, "control", inside=True)
WHEELS = Topic("wheels", m.Wheels, 100, "control", inside=True)
ATTITUDE = Topic("attitude", m.Attitude, 100, "control", inside=True)
ODOM = Topic("odom", m.Odometry, 100, "state")
BASE = Topic("base", m.BaseState, 10, "state")
BATTERY = Topic("battery", m.Battery, 2, "state")
GUARD = Topic("guard", m.GuardState, 10, "state", size=1000)
ESTOP = Topic("estop", m.EStop, 2, "control", inside=True)
MOTION = Topic("motion", mo.MotionState, 10, "state")
MOTION_HOLD = Topic("motion/hold", mo.MotionHold, 25, "control")
POSE = Topic("pose", lo.MapPose, 10, "state", size=600)
PARTICLES = Topic("particles", lo.Particles, 2, "state", size=8000)
MAP = Topic("map", lo.MapWalls, 0.2, "state", size=16_000)
PLACES = Topic("places", pl.Places, 1, "state", size=1000)
PLACES_HOLD = Topic("places/hold", mo.MotionHold, 25, "control")
ROUTE = Topic("route", pl.RouteState, 5, "state", size=800)
CAMERA = Topic("camera/*/@full", c.Picture, 15, "bulk", "camera")
CAMERA_SMALL = Topic("camera/*/@small", c.Picture, 15, "bulk", "camera")
CAMERA_ON = Topic("camera/*/on", c.CameraHold, 5, "state", "camera")
CAMERA_STATE = Topic("camera/*/state", c.CameraState, 5, "state", "camera", size=1000)
CAMERA_PICTURES = (CAMERA, CAMERA_SMALL)
"""What a camera sees. A chunk that begins with `@` is matched by no wildcard: who listens to all that a robot says does
not see through its camera, nor does his link carry pictures."""
VISUAL_ODOM = Topic("visual_odom", c.VisualOdometry, 15, "state")
TRUE_POSE = Topic("true_pose", m.TruePose, 5, "state")
SERIAL = Topic("serial/*", m.SerialLine, 0, "state", "name")
SERIAL_WRITE = Topic("serial_write/*", m.SerialWrite, 0, "state", "name")

TOPICS: tuple[Topic[Any], ...] = (
    TICK,
    TILT,
    OPERATOR_CMD_VEL,
    LEASE,
    RANGE,
    BUMPER,
    SCAN,
    CMD_VEL,
    WHEELS,
    ATTITUDE,
    ODOM,
    BASE,
    BATTERY,
    GUARD,
    ESTOP,
    MOTION,
    MOTION_HOLD,
    POSE,
    PARTICLES,
    MAP,
    PLACES,
    PLACES_HOLD,
    ROUTE,
    CAMERA,
    CAMERA_SMALL,
    CAMERA_ON,
    CAMERA_STATE,
    VISUAL_ODOM,
    TRUE_POSE,
    SERIAL,
    SERIAL_WRITE,
)

ESTOP_ENGAGE = Query("estop/engage", r.EStopEngage, r.EStopAnswer, r.UNREADABLE_STOP)
ESTOP_RESET = Query("estop/reset", r.EStopReset, r.EStopAnswer)

ODOM_RESET = Query("odom/reset", r.OdomReset, r.OdomAnswer)
ODOM_SET_POSE = Query("odom/set_pose", r.OdomSetPose, r.OdomAnswer)
ODOM_ECHOES = Query("odom/echoes", r.OdomEchoes, r.EchoMap)

LOCALIZATION_SET_POSE = Query("localization/set_pose", lo.LocalizationSetPose, lo.LocalizationAnswer)
LOCALIZATION_GLOBAL = Query("localization/global", lo.LocalizationGlobal, lo.LocalizationAnswer)
PLACES_SET = Query("places/set", pl.PlacesSet, pl.PlacesAnswer)

QUERIES: tuple[Query[Any, Any], ...] = (
    ESTOP_ENGAGE,
    ESTOP_RESET,
    ODOM_RESET,
    ODOM_SET_POSE,
    ODOM_ECHOES,
    LOCALIZATION_SET_POSE,
    LOCALIZATION_GLOBAL,
    PLACES_SET,
)
"""Queries of base, odometry, localization and places."""

MOTION_MOVE = Query("motion/move", mo.MotionMove, mo.MotionAnswer)
MOTION_TURN = Query("motion/turn", mo.MotionTurn, mo.MotionAnswer)
MOTION_ARC = Query("motion/arc", mo.MotionArc, mo.MotionAnswer)
MOTION_GO = Query("motion/go", mo.MotionGo, mo.MotionAnswer)
MOTION_CANCEL = Query("motion/cancel", mo.MotionCancel, mo.MotionAnswer, mo.MotionCancel(by="somebody unknown"))

MOTION_QUERIES: tuple[Query[Any, Any], ...] = (MOTION_MOVE, MOTION_TURN, MOTION_ARC, MOTION_GO, MOTION_CANCEL)
"""Of motion."""

PLACES_GO = Query("places/go", pl.PlacesGo, mo.MotionAnswer)
PLACES_CANCEL = Query("places/cancel", mo.MotionCancel, mo.MotionAnswer, mo.MotionCancel(by="somebody unknown"))

DRIVING_QUERIES: tuple[Query[Any, Any], ...] = (*MOTION_QUERIES, PLACES_GO, PLACES_CANCEL)
"""Queries of motion and of places that make the robot move, or end that: one permission is for all of them."""

# Apart, because access is granted by key: who may read a parameter may not set it.
PARAM_DESCRIBE = Query("param/*", p.ParamDescribe, p.ParamAnswer)
PARAM_SET = Query("param/*/set", p.ParamSet, p.ParamAnswer)
PARAM_SAVE = Query("param/*/save", p.ParamSave, p.ParamAnswer)

PARAM_QUERIES: tuple[Query[Any, Any], ...] = (PARAM_DESCRIBE, PARAM_SET, PARAM_SAVE)
"""Of every service that is a `Node`."""


def key_of(robot: str, topic: Topic[Any] | Query[Any, Any]) -> str:
    """The whole key of a topic or query: a key expression while it still has a `*`."""
    return f"{ROOT}/{require_chunk(robot)}/{topic.key}"


def key_below(robot: str, below: str) -> str:
    """The whole key of what a robot says on `below`: of any key, or key expression, that is in this table or not."""
    return f"{ROOT}/{require_chunk(robot)}/{below}"


def covers(topic: Topic[Any], key: str) -> bool:
    """Whether a key below the robot's name is of this row: of `range/*` as much as `range/rear` is."""
    if "*" not in topic.key:
        return key == topic.key
    return key.count("/") == topic.key.count("/") and topic.key.replace("*", topic.name_in(key)) == key


def topic_of(key: str) -> Topic[Any] | None:
    """The row of a key below the robot's name: of `range/rear` that of `range/*`; None: the table has none."""
    for topic in TOPICS:
        if key == topic.key or (covers(topic, key) and _is_chunk(topic.name_in(key))):
            return topic
    return None


def alive_key(robot: str, service: str = "*", instance: str = "*") -> str:
    """Liveliness token of one process."""
    return f"{ROOT}/{robot}/alive/{service}/{instance}"


def health_key(robot: str, service: str = "*") -> str:
    """Queryable that answers with a `Health`."""
    return f"{ROOT}/{robot}/health/{service}"


def frame_key(robot: str, child: str = "*") -> str:
    """Queryable that answers with a `Transform`: where a frame is in its parent."""
    return f"{ROOT}/{robot}/frame/{child}"


def require_chunk(name: str) -> str:
    """Return `name`, if it can be one chunk of a key; else raise ValueError."""
    if len(name) > LONGEST_CHUNK:
        raise ValueError(f"{name[:20]!r}... has {len(name)} characters: use {LONGEST_CHUNK} at most")
    # Dots alone name a folder, and a robot has one of its name.
    if not name.strip(".") or not name.isascii() or any(c in "/*$?# \"'`" or not c.isprintable() for c in name):
        raise ValueError(f"{name!r} cannot be part of a key: use letters, digits, '-' and '_'")
    return name


def _is_chunk(name: str) -> bool:
    try:
        require_chunk(name)
    except ValueError:
        return False
    return True
