"""A robot in order as `giraff why` hears it, and everything that can stop it: the link to blame, and its words."""

from collections.abc import Callable
from typing import Any

import msgspec

from giraff_cli.why.chain import Observation
from giraff_cli.why.explain import Diagnosis, diagnose
from giraff_schemas import topics
from giraff_schemas.codec import stamped
from giraff_schemas.health import Health
from giraff_schemas.messages import DirectionLimit, DriveCommand, GuardState, Tick, Tilt
from giraff_schemas.topics import Topic
from giraff_schemas.trouble import Trouble
from tests.unit.cli.samples import (
    EPOCH,
    MS,
    SENSORS,
    at,
    base,
    estop,
    guard,
    lease,
    reading,
    verdict,
    wheels,
    wish,
)

NOW = 10_000 * MS
HAND = "hand"
HELD = (
    "not armed since the left wheel was held: clear the way, or check its encoder, motor and battery; "
    "hold the hand level for 0.2 s"
)
SERVICES: tuple[str, ...] = ("joystick", "guard", "base", "ranger", "odometry")

Sent = tuple[Topic[Any], str, Any, str]
"""Topic, name that stands for its `*`, sample, maker."""


def command(linear: float = 0.0, angular: float = 0.0, **fields: Any) -> DriveCommand:
    return msgspec.structs.replace(wish(linear, angular, NOW - 30 * MS), **fields)


def tilt(status: Any = "running", known: bool = True) -> Tilt:
    return Tilt(x=0.0, y=0.0, z=9.81, status=status, tick=at(NOW) if known else None)


def state(**fields: Any) -> GuardState:
    return msgspec.structs.replace(guard(verdict()), **fields)


def blocked(sensor: str = "front_left", reason: str = "") -> DirectionLimit:
    return verdict(0.0, "blocked", sensor, reason or f"{sensor} sees something at 0.31 m", "turn left or back up")


class Scene:
    """A robot that is armed and waits for a level hand to tilt, until something of it is changed."""

    def __init__(self) -> None:
        self.sent: dict[tuple[str, str], Sent] = {}
        self.alive = set(SERVICES)
        self.health: list[Health] = []
        self.hung: frozenset[str] = frozenset()
        self.put(topics.TICK, Tick(epoch=EPOCH, robot_ns=NOW), "b")
        self.put(topics.TILT, tilt(), HAND)
        self.put(topics.OPERATOR_CMD_VEL, command(), HAND, "joystick")
        self.put(topics.LEASE, lease(HAND), "g")
        for sensor in SENSORS:
            self.put(topics.RANGE, reading(sensor, 1.5), "r", sensor)
        self.put(topics.GUARD, state(), "g")
        self.put(topics.BASE, msgspec.structs.replace(base(), driving=False), "b")
        self.put(topics.ESTOP, estop(), "b")
        self.put(topics.WHEELS, wheels(NOW), "b")

    def put(self, topic: Topic[Any], sample: Any, maker: str, name: str = "") -> "Scene":
        self.sent[topic.at(name).key if name else topic.key, maker] = topic, name, sample, maker
        return self

    def drop(self, *gone: Topic[Any]) -> "Scene":
        """These are not heard."""
        keys = {topic.key for topic in gone}
        self.sent = {place: sent for place, sent in self.sent.items() if sent[0].key not in keys}
        return self

    def end(self, service: str) -> "Scene":
        """A service that is not running, with all that follows."""
        self.alive.remove(service)
        {"joystick": self._no_joystick, "guard": self._no_guard, "base": self._no_base, "ranger": self._no_ranger}[
            service
        ]()
        return self

    def complain(self, service: str, what: str | Trouble) -> "Scene":
        """A service that is there, and says what is wrong with it."""
        self.alive.add(service)
        faults = (Trouble(what) if isinstance(what, str) else what,)
        self.health.append(Health(service=service, instance="0", host="h", pid=1, uptime=1.0, ok=False, faults=faults))
        return self

    def hang(self, service: str, *topics: Topic[Any]) -> "Scene":
        """A service that is there, does not answer, and is not heard on `topics`."""
        self.hung = frozenset({service})
        return self.drop(*topics)

    def diagnosis(self) -> Diagnosis:
        observation = Observation("otto")
        for (key, _), (topic, _, sample, maker) in self.sent.items():
            observation.on_sample(topic, key, stamped(sample, 0, 0, maker), NOW)
        for service in self.alive:
            observation.on_liveliness(service, service, present=True)
        observation.health, observation.hung = self.health, self.hung
        observation.now_ns = NOW + 10 * MS
        return diagnose(observation)

    def _no_joystick(self) -> None:
        self.drop(topics.TILT, topics.OPERATOR_CMD_VEL)
        self.put(topics.LEASE, lease("", ""), "g")
        self.put(topics.BASE, base(armed=False, reason="not armed"), "b")

    def _no_guard(self) -> None:
        self.drop(topics.GUARD, topics.CMD_VEL, topics.LEASE)
        self.put(topics.BASE, base(armed=False, reason="the guard is not heard"), "b")

    def _no_base(self) -> None:
        self.drop(topics.TICK, topics.BASE, topics.ESTOP, topics.WHEELS)
        self.put(topics.TILT, tilt(known=False), HAND)
        deaf = command(source="fault", reason=Trouble("the joystick has not heard the robot yet"), tick=None)
        self.put(topics.OPERATOR_CMD_VEL, deaf, HAND, "joystick")
        self.put(topics.GUARD, state(reason=Trouble("base is not heard")), "g")
        self.put(topics.LEASE, lease("", ""), "g")

    def _no_ranger(self) -> None:
        self.drop(topics.RANGE)
        blind = blocked(reason="front_left is stale")
        self.put(topics.GUARD, state(forward=blind, backward=blocked("rear", "rear is stale")), "g")


def fault(reason: str) -> DriveCommand:
    return command(source="fault", reason=Trouble(reason))


Change = Callable[[Scene], object]

CAUSES: dict[str, tuple[Change, str, str]] = {
    "no joystick": (
        lambda s: s.end("joystick"),
        "operator",
        "no operator is heard; start giraff_joystick or giraff_key",
    ),
    "no program of ROS": (
        lambda s: s.end("joystick").alive.add("ros2"),
        "operator",
        "no program of ROS publishes cmd_vel, where giraff_ros2 listens; start one",
    ),
    "a program of ROS that does not count": (
        lambda s: s.end("joystick").complain("ros2", "messages on /cmd_vel count for nothing"),
        "operator",
        "giraff_ros2: messages on /cmd_vel count for nothing",
    ),
    "no guard": (
        lambda s: s.end("guard"),
        "guard",
        "giraff_guard is not running, or hangs; start it on base's machine",
    ),
    "no base": (lambda s: s.end("base"), "base", "giraff_base is not running, or hangs; start it on the machine"),
    "no ranger": (
        lambda s: s.end("ranger"),
        "ranger",
        "giraff_ranger is not running, or hangs; start it on the machine",
    ),
    "hung joystick": (
        lambda s: s.hang("joystick", topics.TILT, topics.OPERATOR_CMD_VEL),
        "operator",
        "giraff_joystick: is on the network and does not answer; it hangs: restart it",
    ),
    "hung guard": (
        lambda s: s.hang("guard", topics.GUARD, topics.LEASE),
        "guard",
        "giraff_guard: is on the network and does not answer; it hangs",
    ),
    "late guard": (
        lambda s: s.drop(topics.GUARD, topics.LEASE),
        "guard",
        "giraff_guard: is on the network and has not answered yet; ask again",
    ),
    "hung base": (
        lambda s: s.hang("base", topics.TICK, topics.BASE, topics.ESTOP, topics.WHEELS),
        "base",
        "giraff_base: is on the network and does not answer",
    ),
    "no base any more": (
        lambda s: (
            s.end("base")
            .put(topics.TILT, tilt(), HAND)
            .put(topics.OPERATOR_CMD_VEL, fault("no tick of the robot has come for 0.5 s"), HAND, "joystick")
        ),
        "base",
        "giraff_base is not running, or hangs",
    ),
    "no clock": (lambda s: s.drop(topics.TICK), "base", "it gives no clock; restart giraff_base"),
    "sensor in hand": (
        lambda s: s.put(topics.TILT, tilt("bus_fault"), HAND).put(
            topics.OPERATOR_CMD_VEL, fault("press its shield"), HAND, "joystick"
        ),
        "hand",
        "press its shield",
    ),
    "laid down": (
        lambda s: s.put(topics.OPERATOR_CMD_VEL, fault("the joystick lies still; hold it"), HAND, "joystick"),
        "hand",
        "the joystick lies still; hold it",
    ),
    "deaf joystick": (
        lambda s: s.put(
            topics.OPERATOR_CMD_VEL, command(source="fault", reason=Trouble("no tick"), tick=None), HAND, "joystick"
        ),
        "operator",
        "joystick does not hear the robot, which is heard here; check its network",
    ),
    "slow link": (
        lambda s: s.put(topics.OPERATOR_CMD_VEL, command(0.3, tick=at(NOW - 700 * MS)), HAND, "joystick"),
        "operator",
        "joystick asks for 0.30 m/s, 0.00 rad/s, 700 ms old: too old; bring it nearer",
    ),
    "keyboard's fault": (
        lambda s: s.drop(topics.TILT, topics.OPERATOR_CMD_VEL).put(
            topics.OPERATOR_CMD_VEL,
            msgspec.structs.replace(fault("the terminal is gone"), operator="keyboard"),
            HAND,
            "keyboard",
        ),
        "operator",
        "keyboard: the terminal is gone",
    ),
    "second joystick": (
        lambda s: s.put(topics.OPERATOR_CMD_VEL, command(), "impostor", "joystick"),
        "operator",
        "2 operators called joystick run under this name (hand, impostor); end all but one",
    ),
    "free lease": (
        lambda s: s.put(
            topics.LEASE, msgspec.structs.replace(lease("", ""), reason=Trouble("tilt to ask for it")), "g"
        ),
        "lease",
        "nobody holds it; tilt to ask for it",
    ),
    "someone else's lease": (
        lambda s: s.put(topics.LEASE, msgspec.structs.replace(lease("k", "keyboard"), reason=Trouble("wait 1 s")), "g"),
        "lease",
        "held by keyboard, who is not heard here; wait 1 s",
    ),
    "blind sensor ahead": (
        lambda s: (
            s.put(topics.OPERATOR_CMD_VEL, command(0.3), HAND, "joystick")
            .put(topics.RANGE, reading("front_left", None, "fault", "its echo wire is off"), "r", "front_left")
            .put(topics.GUARD, state(forward=blocked(reason="front_left is faulty")), "g")
        ),
        "ranger",
        "front_left: its echo wire is off",
    ),
    "ranger's board": (
        lambda s: s.end("ranger").complain("ranger", "no such port"),
        "ranger",
        "giraff_ranger: no such port",
    ),
    "obstacle": (
        lambda s: (
            s.put(topics.OPERATOR_CMD_VEL, command(0.3), HAND, "joystick")
            .put(topics.GUARD, state(forward=blocked()), "g")
            .put(topics.BASE, base(armed=True, reason="forward blocked"), "b")
        ),
        "guard",
        "forward blocked: front_left sees something at 0.31 m; turn left or back up",
    ),
    "walls all around": (
        lambda s: s.put(topics.GUARD, state(forward=blocked(), backward=blocked("rear")), "g"),
        "guard",
        "backward blocked: rear sees something at 0.31 m",
    ),
    "two guards": (
        lambda s: s.put(topics.GUARD, state(), "h").put(topics.LEASE, lease("", ""), "g"),
        "guard",
        "2 giraff_guard run under this name (g, h); end all but one",
    ),
    "two bases": (lambda s: s.put(topics.BASE, base(), "c"), "base", "2 giraff_base run under this name (b, c)"),
    "e-stop": (
        lambda s: (
            s.put(topics.ESTOP, estop(engaged=True), "b")
            .put(topics.BASE, base(armed=False, reason="emergency stop", latch="estop"), "b")
            .put(topics.LEASE, lease("", ""), "g")
        ),
        "e-stop",
        "smoke; see that the robot may move, then run `giraff estop reset` to release it, then hold the hand level",
    ),
    "one of two bases stopped": (
        lambda s: s.put(topics.ESTOP, estop(engaged=True), "c"),
        "e-stop",
        "engaged by ann@desk",
    ),
    "unplugged board": (
        lambda s: (
            s.put(topics.BASE, disconnected(), "b")
            .put(topics.LEASE, lease("", ""), "g")
            .complain("base", "/dev/giraff-base: unplugged")
            .drop(topics.WHEELS)
        ),
        "board",
        "/dev/giraff-base: unplugged",
    ),
    "stuck wheel": (
        lambda s: s.put(topics.BASE, base(armed=False, reason="latched", latch="left_stuck"), "b"),
        "board",
        "latched: left_stuck; run `giraff estop reset`",
    ),
    "held wheel": (
        lambda s: s.put(topics.BASE, base(armed=False, reason=HELD, drive_state="held"), "b"),
        "board",
        HELD,
    ),
    "not armed": (
        lambda s: s.put(topics.BASE, base(armed=False, reason="not armed since a reset; hold the hand level"), "b"),
        "base",
        "not armed since a reset; hold the hand level",
    ),
    "no wheels": (lambda s: s.drop(topics.WHEELS), "wheels", "base tells nothing of them"),
}


def disconnected() -> Any:
    board = msgspec.structs.replace(base().board, connected=False, latch="")
    return msgspec.structs.replace(base(armed=False, reason="the serial link was lost"), board=board)
