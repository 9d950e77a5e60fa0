"""Who may do what on a secured network: table `[network.access]` of the robot file, as Zenoh's access control takes it.

Hosts are known by the common names of their certificates (`giraff keys`). Every node of every host enforces the same
rules: peers link directly, so a node without them is an open door.
"""

from typing import Any, Final

import msgspec

from giraff_schemas.services import CAMERA, MOTION, OPERATORS
from giraff_schemas.topics import (
    CAMERA_ON,
    CAMERA_PICTURES,
    DRIVING_QUERIES,
    ESTOP_ENGAGE,
    MOTION_HOLD,
    ODOM_ECHOES,
    OPERATOR_CMD_VEL,
    PARAM_DESCRIBE,
    PARAM_QUERIES,
    PLACES_HOLD,
    QUERIES,
    ROOT,
    TILT,
    TOPICS,
    Topic,
    alive_key,
    frame_key,
    health_key,
    require_chunk,
)

_ASKS: Final = ("declare_subscriber", "declare_liveliness_subscriber", "liveliness_query")
_LOOKS: Final = ("declare_liveliness_subscriber", "liveliness_query")
_TELLS: Final = ("put", "delete", "reply", "declare_queryable", "liveliness_token")
_ALL: Final = (*_ASKS, *_TELLS, "query")
_SOCKET: Final = "unixsock-stream"
_LINKS: Final = ("tcp", "tls", "udp", "quic", "ws")
"""Zenoh's words for the links to other hosts."""
_OWN_HOST: Final = "this host"
_DOES_ALL: Final = "does all"
_NO_HANDS: Final = (MOTION.name, CAMERA.name)
"""Names of an operator that grant something else than to drive."""


class AccessConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which certificate is whose. A host that is named nowhere can do nothing, nor can a stranger."""

    robot: tuple[str, ...] = ()
    """The robot's own hosts: the only ones whose word moves the motors."""
    operators: dict[str, tuple[str, ...]] = {}
    """Host of an operator -> the names under which it may ask to drive, as in `cmd_vel/<operator>`; `motion`: it may
    ask giraff_motion, which alone says `cmd_vel/motion`; `camera`: it may see what the robot's cameras see."""
    viewers: tuple[str, ...] = ()
    """Hosts that only read, and may stop the robot."""
    routers: tuple[str, ...] = ()
    """Hosts that pass on what operators and viewers of other networks say: `giraff_router`."""

    def __post_init__(self) -> None:
        twice = sorted({host for host in self.hosts if self.hosts.count(host) > 1})
        if twice:
            raise ValueError(f"{', '.join(twice)}: one host has one certificate and one part")
        for name in (*self.hosts, *(name for names in self.operators.values() for name in names)):
            require_chunk(name)

    @property
    def hosts(self) -> tuple[str, ...]:
        """Every host that may do anything."""
        return (*self.robot, *self.operators, *self.viewers, *self.routers)


def access_control(access: AccessConfig, robot: str, me: str = "") -> dict[str, Any]:
    """Zenoh's rules, subjects and policies for one node of this robot; "*": of any. `me`: the node's own host.

    A rule is about what comes in from a subject or goes out to it. No key here has a `**` below `cmd_vel`: it would
    match `cmd_vel` itself, and open base's door to whoever may ask to drive.
    """
    below = f"{ROOT}/{robot}"
    everything = f"{below}/**"
    pictures = [f"{below}/{topic.key}" for topic in CAMERA_PICTURES]  # `**` is no picture
    rules = [
        _rule("all are told", "egress", _TELLS, everything),
        _rule("all are asked", "egress", (*_ASKS, "query"), everything),
        _rule("all may listen", "ingress", _ASKS, everything),
        _rule("all may look for robots", "ingress", _LOOKS, alive_key("*")) | {"flows": ["ingress", "egress"]},
        _rule(
            "all may stop",
            "ingress",
            ("query",),
            *(f"{below}/{query.key}" for query in (ESTOP_ENGAGE, PARAM_DESCRIBE, ODOM_ECHOES)),
            health_key(robot),
            frame_key(robot),
        ),
        _rule("the robot tells", "ingress", (*_TELLS, "query"), everything),
        _rule("some see", "egress", ("put",), *pictures),
        _rule("some look", "ingress", ("declare_subscriber",), *pictures) | {"flows": ["ingress", "egress"]},
        _rule("the robot shows", "ingress", ("put",), *pictures),
    ]
    subjects = [
        _subject("known", access.hosts),
        _subject("seeing", _who_sees(access)),
        _subject("robot", access.robot),
    ]
    policies = [
        _policy("known", "all are told", "all are asked", "all may listen", "all may look for robots", "all may stop"),
        _policy("seeing", "some see", "some look"),
        _policy("robot", "the robot tells", "the robot shows"),
    ]
    operators = access.operators
    if me in (*access.operators, *access.viewers):
        # Nothing there moves a motor, and all that comes from the robot comes with the router's certificate.
        if access.routers:
            subjects.append(_subject("router", access.routers))
            shown = ("the robot shows",) if me in _who_sees(access) else ()
            policies.append(_policy("router", "the robot tells", *shown))
    else:
        # Who it was that spoke is seen by the router alone. So the robot takes of it what some operator may say: never
        # a word of its own hosts, whatever the router says or has become.
        anybodys = tuple(sorted({name for names in operators.values() for name in names}))
        operators = operators | dict.fromkeys(access.routers, anybodys)
    for host, names in operators.items():
        subject, drives, present, asks = f"operator {host}", f"{host} drives", f"{host} is there", f"{host} asks"
        says: list[Topic[Any]] = [OPERATOR_CMD_VEL.at(name) for name in names if name not in _NO_HANDS] + [TILT]
        queries = [*QUERIES, *PARAM_QUERIES]
        if MOTION.name in names:
            says += (MOTION_HOLD, PLACES_HOLD)
            queries += DRIVING_QUERIES
        if CAMERA.name in names:
            says.append(CAMERA_ON)
        rules += [
            _rule(drives, "ingress", ("put",), *(f"{below}/{topic.key}" for topic in says)),
            _rule(
                present,
                "ingress",
                ("liveliness_token", "declare_queryable", "reply"),
                *(
                    key
                    for service in (each.name for each in OPERATORS)
                    for key in (
                        alive_key(robot, service),
                        health_key(robot, service),
                        *(f"{below}/{query.at(service).key}" for query in PARAM_QUERIES),
                    )
                ),
            ),
            _rule(asks, "ingress", ("query",), *(f"{below}/{query.key}" for query in queries)),
        ]
        subjects.append(_subject(subject, (host,)))
        policies.append(_policy(subject, drives, present, asks))
    return {"rules": rules, "subjects": subjects, "policies": policies}


def with_own_host(rules: dict[str, Any]) -> dict[str, Any]:
    """Add to Zenoh's rules of a node that processes of its own host, which it meets at Unix sockets, do all."""
    return rules | {
        "rules": [
            *rules.get("rules", ()),
            _rule(_DOES_ALL, "ingress", _ALL, "**", *(f"{ROOT}/*/{topic.key}" for topic in CAMERA_PICTURES))
            | {"flows": ["ingress", "egress"]},
        ],
        "subjects": [*rules.get("subjects", ()), {"id": _OWN_HOST, "link_protocols": [_SOCKET]}],
        "policies": [*rules.get("policies", ()), _policy(_OWN_HOST, _DOES_ALL)],
    }


def with_inside(rules: dict[str, Any], *, is_split: bool) -> dict[str, Any]:
    """Add to Zenoh's rules of a node inside that what base and guard act on comes from its own host alone.

    `is_split`: a part of the robot is on another host. Zenoh looks at a link when it begins. A second link to a peer
    would count as the first, so door and hands have no socket at all (`giraff_node.network.session`).
    """
    held = _rule(
        "inside only", "ingress", ("put", "delete"), *(f"{ROOT}/*/{topic.key}" for topic in TOPICS if topic.inside)
    )
    control = with_own_host({"enabled": True, "default_permission": "deny"} | rules)
    # The only one of a secured network who may say it; of several subjects one that may is enough.
    whom = "robot"
    if not rules:
        whom = "elsewhere"
        control["subjects"].append({"id": whom, "link_protocols": [*_LINKS]})
        control["policies"].append(_policy(whom, _DOES_ALL))
    if not is_split:
        control["rules"].append(held | {"permission": "deny"})
        control["policies"].append(_policy(whom, "inside only"))
    return control


def _who_sees(access: AccessConfig) -> tuple[str, ...]:
    """Hosts that pictures may go to: a router as soon as somebody behind it may have them, whom it knows itself."""
    seers = tuple(host for host, names in access.operators.items() if CAMERA.name in names)
    return (*access.robot, *seers, *(access.routers if seers else ()))


def _rule(name: str, flow: str, messages: tuple[str, ...], *keys: str) -> dict[str, Any]:
    return {"id": name, "flows": [flow], "messages": [*messages], "permission": "allow", "key_exprs": [*keys]}


def _subject(name: str, hosts: tuple[str, ...]) -> dict[str, Any]:
    return {"id": name, "cert_common_names": [*hosts]}


def _policy(subject: str, *rules: str) -> dict[str, Any]:
    return {"rules": [*rules], "subjects": [subject]}
