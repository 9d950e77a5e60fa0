"""The table of services: what each is called, where it runs, and what it says, hears and answers."""

from typing import Any, Final, Literal

import msgspec

from giraff_schemas import topics as t
from giraff_schemas.topics import Query, Topic
from giraff_schemas.wire import BoardKind

_SENSED: Final = (t.RANGE, t.BUMPER, t.SCAN)
"""Topics of the robot's sensors. The guard obeys them, and screens show them."""


class Service(msgspec.Struct, frozen=True, kw_only=True):
    """One row of the table."""

    name: str
    """As in `alive/<name>`, `health/<name>`, `param/<name>`, its compose service and its unit giraff@<name>."""
    host: Literal["robot", "operator", "any", "router"]
    """Where it runs."""
    entry: Literal["service", "hand", "main", ""] = "service"
    """Module of its package that `python -m giraff_node <name>` runs. `service` has the class `<Name>`, whose turns a
    `Node` makes, `hand` has the operator's device `<Name>`, a `Hand` for which that service is there, and `main` a
    function `main`. Empty: a tool that has a token on the network, and no package."""
    publishes: tuple[Topic[Any], ...] = ()
    subscribes: tuple[Topic[Any], ...] = ()
    answers: tuple[Query[Any, Any], ...] = ()
    """Beside those of its parameters and health."""
    board: BoardKind | None = None
    """At its serial port."""
    missing: tuple[Literal["fault", "warning"], str] | None = None
    """How bad it is for a robot when it does not run, and what follows; None: `doctor` does not miss it."""
    optional: bool = False
    """A robot is whole without it."""
    simulated: bool = False
    """A part of every `giraff run`."""
    option: Literal["", "web", "localize", "camera"] = ""
    """Option of `giraff run` that starts it. Empty: none does."""
    libraries: tuple[str, ...] = ()
    """Modules that it imports, and that an installation may lack."""
    extra: str = ""
    """Extra of the distribution that brings them."""
    inside: bool = False
    """It listens to processes of its own host alone."""
    extra_device: bool = False
    """It reads a device that most robots do not have, and is started only where somebody says so."""

    @property
    def package(self) -> str:
        """Its import package, `giraff_<name>`. Empty: it has none."""
        return f"giraff_{self.name}" if self.entry else ""

    @property
    def table(self) -> str:
        """Its table of the robot file, read as `<package>.config:<Name>Config`. Empty: it has none."""
        return self.name if self.entry else ""


JOYSTICK: Final = Service(
    name="joystick",
    host="operator",
    publishes=(t.OPERATOR_CMD_VEL, t.TILT),
    subscribes=(t.TICK, t.LEASE),
    board=BoardKind.JOYSTICK,
    simulated=True,
)
KEYBOARD: Final = Service(
    name="keyboard",
    host="operator",
    entry="main",
    publishes=(t.OPERATOR_CMD_VEL,),
    subscribes=(t.TICK, t.LEASE, t.BASE, t.GUARD, t.ESTOP, t.BATTERY, t.ODOM, *_SENSED),
)
WEB: Final = Service(
    name="web",
    host="operator",
    entry="main",
    publishes=(t.OPERATOR_CMD_VEL, t.PLACES_HOLD),
    subscribes=(
        *(t.TICK, t.LEASE, t.BASE, t.GUARD, t.ESTOP, t.BATTERY, t.ODOM, t.ATTITUDE),
        *(*_SENSED, t.POSE, t.MAP, t.PLACES, t.ROUTE, t.CAMERA_STATE),
    ),
    optional=True,
    option="web",
    libraries=("aiohttp", "cryptography"),
    extra="web",
)
"""A page, for any number of browsers; whoever drives by one of them is this operator."""
CLIENT: Final = Service(
    name="client",
    host="operator",
    entry="",
    publishes=(t.OPERATOR_CMD_VEL, t.MOTION_HOLD, t.PLACES_HOLD),
    subscribes=(t.TICK, t.LEASE, t.BASE, t.ESTOP, t.BATTERY, t.GUARD, t.ODOM, t.POSE, *_SENSED, t.MOTION, t.ROUTE),
)
"""A script of somebody's own, with `giraff_client`."""
ROS2: Final = Service(
    name="ros2",
    host="operator",
    entry="main",
    publishes=(t.OPERATOR_CMD_VEL, t.MOTION_HOLD, t.PLACES_HOLD),
    subscribes=(
        *(t.TICK, t.LEASE, t.BASE, t.GUARD, t.ESTOP, t.BATTERY, t.ODOM, *_SENSED, t.TILT),
        *(t.POSE, t.MAP, t.MOTION, t.PLACES, t.ROUTE),
    ),
    optional=True,
    libraries=("numpy", "rosbags", "xxhash"),
    extra="ros2",
)
"""The robot in ROS 2. Every program of ROS that drives it is this operator."""
BASE: Final = Service(
    name="base",
    host="robot",
    missing=("fault", "nothing moves"),
    publishes=(t.TICK, t.WHEELS, t.ATTITUDE, t.BASE, t.ESTOP, t.BATTERY),
    subscribes=(t.CMD_VEL, t.VISUAL_ODOM),
    answers=(t.ESTOP_ENGAGE, t.ESTOP_RESET),
    board=BoardKind.BASE,
    simulated=True,
    inside=True,
)
GUARD: Final = Service(
    name="guard",
    host="robot",
    missing=("fault", "nothing moves: base obeys the guard alone"),
    publishes=(t.CMD_VEL, t.LEASE, t.GUARD),
    subscribes=(t.TICK, *_SENSED, t.WHEELS, t.ATTITUDE, t.OPERATOR_CMD_VEL),
    simulated=True,
    inside=True,
)
RANGER: Final = Service(
    name="ranger",
    host="robot",
    missing=("fault", "the robot is blind, and guard stops it"),
    publishes=(t.RANGE, t.BUMPER),
    subscribes=(t.TICK,),
    board=BoardKind.RANGER,
    simulated=True,
    inside=True,
)
SCAN: Final = Service(
    name="scan",
    host="robot",
    missing=("fault", "the robot does not see all round, and guard stops it"),
    publishes=(t.SCAN,),
    subscribes=(t.TICK, t.ODOM),
    optional=True,
    inside=True,
    extra_device=True,
)
ODOMETRY: Final = Service(
    name="odometry",
    host="robot",
    missing=("warning", "nobody knows where the robot is"),
    publishes=(t.ODOM,),
    subscribes=(t.WHEELS, t.RANGE),
    answers=(t.ODOM_RESET, t.ODOM_SET_POSE, t.ODOM_ECHOES),
    simulated=True,
    inside=True,
)
MOTION: Final = Service(
    name="motion",
    host="robot",
    publishes=(t.OPERATOR_CMD_VEL, t.MOTION),
    subscribes=(t.TICK, t.LEASE, t.ODOM, t.POSE, t.MAP, t.BASE, t.ESTOP, t.GUARD, t.MOTION_HOLD),
    answers=t.MOTION_QUERIES,
    optional=True,
    simulated=True,
    inside=True,
)
"""An operator that others ask for motions by metres and radians."""
LOCALIZATION: Final = Service(
    name="localization",
    host="any",
    entry="main",
    publishes=(t.POSE, t.PARTICLES, t.MAP),
    subscribes=(t.ODOM, t.RANGE, t.SCAN),
    answers=(t.LOCALIZATION_SET_POSE, t.LOCALIZATION_GLOBAL),
    optional=True,
    option="localize",
    libraries=("numpy",),
    extra="localization",
)
"""Tells where the robot is on a map. No part of what keeps it from obstacles."""
PLACES: Final = Service(
    name="places",
    host="any",
    entry="main",
    publishes=(t.PLACES, t.ROUTE, t.MOTION_HOLD),
    subscribes=(
        *(t.TICK, t.LEASE, t.ESTOP, t.POSE, t.MAP, t.RANGE, t.SCAN),
        *(t.MOTION, t.PLACES, t.PLACES_HOLD),
    ),
    answers=(t.PLACES_SET, t.PLACES_GO, t.PLACES_CANCEL),
    optional=True,
    option="localize",
    libraries=("numpy",),
    extra="localization",
)
"""Knows places by name on the floor plan, and has the robot go there. No part of what keeps it from obstacles."""
CAMERA: Final = Service(
    name="camera",
    host="robot",
    entry="main",
    publishes=(t.CAMERA, t.CAMERA_SMALL, t.CAMERA_STATE),
    subscribes=(t.TICK, t.CAMERA_ON),
    optional=True,
    option="camera",
    libraries=("cv2", "numpy"),
    extra="camera",
)
"""Shows who has asked for it what a camera sees. No part of what keeps the robot from obstacles."""
VISION: Final = Service(
    name="vision",
    host="robot",
    entry="main",
    publishes=(t.VISUAL_ODOM, t.CAMERA_ON),
    subscribes=(t.ODOM, t.CAMERA_STATE, t.CAMERA, t.CAMERA_SMALL),
    optional=True,
    option="camera",
    libraries=("cv2", "numpy"),
    extra="camera",
)
"""Tells how a camera sees the robot move over the floor. It looks at the camera as long as it runs."""
RECORDER: Final = Service(name="recorder", host="any", entry="main", optional=True)
"""Hears all that there is."""
DOOR: Final = Service(
    name="door",
    host="robot",
    missing=("fault", "other machines do not find the robot"),
    entry="main",
    optional=True,
    simulated=True,
)
"""The process of the robot that other hosts find, and through which their commands hear all of it."""
SENTRY: Final = Service(name="sentry", host="robot", entry="main", optional=True)
GATEWAY: Final = Service(
    name="gateway",
    host="any",
    publishes=(t.SERIAL,),
    subscribes=(t.SERIAL_WRITE,),
    optional=True,
)
ROUTER: Final = Service(name="router", host="router", entry="main", optional=True)
RUN: Final = Service(name="run", host="any", entry="", publishes=(t.TRUE_POSE,), optional=True)
"""`giraff run`: a simulated robot, of which it knows the truth."""
PLAY: Final = Service(name="play", host="any", entry="", optional=True)
"""`giraff play`: a robot that is played from a recording."""

SERVICES: Final = tuple(row for row in [*globals().values()] if isinstance(row, Service))
"""All rows, in the order above."""

OPERATORS: Final = tuple(service for service in SERVICES if service.host == "operator")
"""Who may ask to drive."""
SCRIPT: Final = "script"
"""Name under which a script asks to drive when it gives no other."""
DEMONSTRATION: Final = "demo"
"""Name under which the joystick of `giraff run` asks to drive."""
HANDS: Final = tuple(service.name for service in OPERATORS if service.package and service is not ROS2)
"""Names of the operators that a person drives by. A script and a program of ROS are not persons."""
ROBOTS_OWN: Final = tuple(service.name for service in SERVICES if service.host == "robot" and not service.optional)
"""Names of those that every robot has."""
WATCHED: Final = (*ROBOTS_OWN, JOYSTICK.name)
"""Names of those whose end is an incident while the robot is armed."""
INSTALLED: Final = (DOOR.name, *(service.name for service in SERVICES if service.inside and not service.extra_device))
"""Names of those that are started on a robot's computer unless somebody says otherwise."""
ANSWERING: Final = frozenset(service.name for service in SERVICES if service.table and service.host != "router")
"""Names of those that answer for their parameters on the robot's network."""
ROBOT_TABLES: Final = ("robot", "network", *(service.table for service in SERVICES if service.table), "sim")
"""Names of the tables of a robot file."""
ROLES: Final = {
    "robot": INSTALLED,
    "laptop": tuple(service.name for service in OPERATORS if service.board is not None),
    "": (),
}
"""Names of those that `make install ROLE=…` starts, and the compose file with this profile."""
SIMULATED: Final = tuple(service.name for service in SERVICES if service.simulated)
"""Names of those that every `giraff run` starts."""
