"""Two robots at two sites, and those who drive and watch them from a third: sessions, with a router between them."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

from giraff_schemas.topics import (
    ESTOP_ENGAGE,
    ESTOP_RESET,
    ODOM,
    OPERATOR_CMD_VEL,
    TICK,
    TOPICS,
    alive_key,
    key_of,
)
from tests.support.behind_router import BehindRouter, Host
from tests.support.process_robot import PATIENCE
from tests.support.sites import ROUTER, Sites
from tests.support.waiting import wait

HOME, CLINIC, AWAY = "home", "clinic", "away"
ANNE, BOB = "sim-anne", "sim-bob"
"""Two robots; one at home, one at the clinic. The laptop drives anne, the doctor both, from away."""
ACCESS: dict[str, dict[str, Any]] = {
    ANNE: {
        "robot": ["anne-pc"],
        "operators": {"laptop": ["joystick"], "doctor": ["doctor"]},
        "viewers": ["desk"],
        "routers": [ROUTER],
    },
    BOB: {"robot": ["bob-pc"], "operators": {"doctor": ["doctor"]}, "routers": [ROUTER]},
}
PLACES = {
    "anne-pc": (HOME, ANNE),
    "bob-pc": (CLINIC, BOB),
    "laptop": (AWAY, ANNE),
    "doctor": (AWAY, ANNE),
    "desk": (AWAY, ANNE),
    "unnamed": (AWAY, ANNE),
}
JOYSTICK, DOCTOR = OPERATOR_CMD_VEL.at("joystick"), OPERATOR_CMD_VEL.at("doctor")
EVERY = (*(topic for topic in TOPICS if not topic.names), JOYSTICK, DOCTOR)
SEVERAL = ("giraff/{}/cmd_vel/*", "giraff/{}/*", "giraff/{}/**", "giraff/*/cmd_vel", "giraff/*/cmd_vel/joystick", "**")

_OF, _LAWLESS = "of", "lawless"
_WAYS = (
    ((_OF, _LAWLESS), "anne-pc", ANNE, TICK, ("laptop", "desk")),
    ((_OF, _LAWLESS), "laptop", ANNE, JOYSTICK, ("anne-pc",)),
    ((_OF, _LAWLESS), "doctor", ANNE, DOCTOR, ("anne-pc",)),
    ((_LAWLESS,), "doctor", BOB, DOCTOR, ("bob-pc",)),  # its own rules are of anne
)
"""Which sessions of whom speak, of which robot, on which topic, and who hears them."""

NO_RULES = {"access_control": {"enabled": False}}
"""A host that does not keep to the rules itself: those of the others must do."""


Heard = dict[Host, list[tuple[str, str]]]
"""(key, text) of what has come to each session."""


class Fleet:
    """That something does not come is shown by what is sent after it on the same way, and does: a mark."""

    def __init__(self, behind: BehindRouter, sites: Sites) -> None:
        self._marks = count()
        self.behind = behind
        self.sites = sites
        behind.start_router()
        for host, (site, _) in PLACES.items():
            behind.certify(host, behind.address(site))
        self.of = {host: behind.join(host, site, robot) for host, (site, robot) in PLACES.items()}
        self.lawless = {host: behind.join(host, site, robot, **NO_RULES) for host, (site, robot) in PLACES.items()}
        self.kinds = {_OF: self.of, _LAWLESS: self.lawless}
        for host, robot in (("anne-pc", ANNE), ("bob-pc", BOB)):
            for session in (self.of[host], self.lawless[host]):
                session.ask("subscribe", *(key_of(other, topic) for other in (ANNE, BOB) for topic in TOPICS))
            self.of[host].ask("answer", key_of(robot, ESTOP_ENGAGE), key_of(robot, ESTOP_RESET))
            self.of[host].ask("be", alive_key(robot, "base", "one"))
        self.of["laptop"].ask("be", alive_key(ANNE, "joystick", "one"))
        self.lawless["laptop"].ask("be", alive_key(ANNE, "guard", "one"))
        for host in ("laptop", "desk", "unnamed"):
            for session in (self.of[host], self.lawless[host]):
                session.ask("subscribe", *(key_of(robot, topic) for robot in (ANNE, BOB) for topic in (ODOM, TICK)))
        self.lawless["doctor"].ask("subscribe", key_of(BOB, TICK))
        self.all_meet()

    def mark(self, speaker: Host, keys: Iterable[str], listeners: Iterable[Host], heard: Heard | None = None) -> None:
        """Wait until each listener has what went the same way before; what they hear meanwhile is put into `heard`."""
        text, waiting = f"mark {next(self._marks)}", set(listeners)

        def has_come() -> bool:
            speaker.ask("put", text, *keys)
            for listener in tuple(waiting):
                news = [(key, said) for key, said in listener.ask("heard")]
                if heard is not None and listener in heard:
                    heard[listener] += news
                if any(said == text for _, said in news):
                    waiting.remove(listener)
            return not waiting

        wait(has_come, PATIENCE)

    def router_has_all_of(self, host: Host, name: str, heard: Heard) -> None:
        """Wait until it has: by what this host may say, or by the end of a question, which goes the same way."""
        match name:
            case "laptop" | "doctor":
                topic = JOYSTICK if name == "laptop" else DOCTOR
                self.mark(host, [key_of(ANNE, topic)], [self.of["anne-pc"]], heard)
            case "bob":
                self.mark(host, [key_of(BOB, TICK)], [self.lawless["doctor"]], heard)
            case _:
                self.answers(host)

    def answers(self, host: Host) -> None:
        """The router has ended a question of this host: it has all of it, and the host all that came before.

        Also one that may say and hear nothing gets an end, of the router alone: while that stands still, it gets none.
        """
        assert host.ask("get", key_of(ANNE, ESTOP_ENGAGE)) in (["done"], [])

    def all_meet(self) -> float:
        """s until each session of a robot hears each of its operators', and each of its readers' hears the robot."""
        waiting = {
            (listener, key_of(robot, topic), f"{kind} {speaker}")
            for kinds, speaker, robot, topic, listeners in _WAYS
            for kind in kinds
            for name in listeners
            for listener in (self.of[name], self.lawless[name])
        }

        def met() -> bool:
            for kinds, speaker, robot, topic, _ in _WAYS:
                for kind in kinds:
                    self.kinds[kind][speaker].ask("put", f"{kind} {speaker}", key_of(robot, topic))
            for listener in {listener for listener, _, _ in waiting}:
                waiting.difference_update((listener, key, text) for key, text in listener.ask("heard"))
            return not waiting

        return wait(met, PATIENCE)

    def say_everything(self, host: Host, text: str) -> dict[str, set[str]]:
        """Keys that each robot's host hears of what `host` says on each key of both robots, and on several at once."""
        robots = {robot: (self.of[f"{robot}-pc"], self.lawless[f"{robot}-pc"]) for robot in ("anne", "bob")}
        heard: Heard = {session: [] for sessions in robots.values() for session in sessions if session is not host}
        for session in heard:
            session.ask("heard")
        host.ask("put", text, *(key_of(robot, topic) for robot in (ANNE, BOB) for topic in EVERY))
        host.ask("put", text, *(several.format(robot) for several in SEVERAL for robot in (ANNE, BOB)))
        self.router_has_all_of(host, text, heard)
        self.mark(self.lawless["doctor"], [key_of(ANNE, DOCTOR), key_of(BOB, DOCTOR)], heard, heard)
        return {
            robot: {
                key.removeprefix("giraff/")
                for session in sessions
                for key, said in heard.get(session, [])
                if said == text
            }
            for robot, sessions in robots.items()
        }


@contextmanager
def fleet(directory: Path) -> Iterator[Fleet]:
    with Sites(HOME, CLINIC, AWAY) as sites:
        behind = BehindRouter(directory, sites, (HOME, CLINIC, AWAY), ACCESS)
        try:
            yield Fleet(behind, sites)
        finally:
            behind.close()
