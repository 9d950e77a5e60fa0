"""What somebody means who types a key: rows of the topics table, and other keys. And what only the robot may say."""

from collections.abc import Iterable, Mapping
from typing import Any, Final

import zenoh

from giraff_schemas.messages import Sample
from giraff_schemas.services import LOCALIZATION, PLACES, PLAY, SERVICES
from giraff_schemas.text import meant
from giraff_schemas.topics import (
    CAMERA_ON,
    CAMERA_PICTURES,
    CMD_VEL,
    DRIVING_QUERIES,
    MOTION_HOLD,
    OPERATOR_CMD_VEL,
    PARAM_QUERIES,
    PLACES_HOLD,
    QUERIES,
    ROOT,
    TOPICS,
    Topic,
    alive_key,
    frame_key,
    health_key,
    key_of,
    require_chunk,
    topic_of,
)

_COMMANDS: Final = (CMD_VEL.key, OPERATOR_CMD_VEL.key, MOTION_HOLD.key, PLACES_HOLD.key)
_ROBOTS_OWN: Final = frozenset(
    topic.key
    for service in SERVICES
    if service.host == "robot" or service in (LOCALIZATION, PLACES)  # by whose word it drives on a map
    for topic in service.publishes
    if topic != CMD_VEL
)
_ASKED: Final = frozenset(query.key for query in (*QUERIES, *DRIVING_QUERIES))
_ASKED_BELOW: Final = tuple(
    f"{key.split('/')[2]}/"
    for key in (alive_key("x"), health_key("x"), frame_key("x"), *(key_of("x", query) for query in PARAM_QUERIES))
)
"""Beginnings of the keys at which a robot's services answer, and are known to be there."""


class UnknownKeyError(Exception):
    """No topic has this key. The message says which are near, or there."""


def find_topic(key: str, there: Iterable[str] = ()) -> Topic[Any]:
    """The topic of a key like `odom`, `range/rear` or `range/*`. Raises UnknownKeyError.

    `there`: keys that are known beside the table's.
    """
    if key.startswith(f"{ROOT}/"):
        raise UnknownKeyError(f"{key}: leave out {ROOT}/<robot>/, --robot names the robot; like odom or range/*")
    if _is_asked(key):
        raise UnknownKeyError(f"{key} is asked, not published: `giraff node list` shows who answers")
    if (row := topic_of(key)) is None:
        raise UnknownKeyError(no_such_key(key, (*(topic.key for topic in TOPICS), *there)))
    return row if row.key == key else row.at(row.name_in(key))


def _is_asked(key: str) -> bool:
    return key in _ASKED or key.startswith(_ASKED_BELOW)


def below_robot(key: str, robot: str | None, said: str = "--robot says") -> tuple[str, str | None]:
    """Return a key, which may be typed whole, below the robot's name, and that name. Raises UnknownKeyError.

    A slash before it, as ROS has it, counts for nothing. `said`: who else names the robot.
    """
    key = key.strip("/") or key
    root, _, rest = key.partition("/")
    named, _, below = rest.partition("/")
    if root != ROOT or not below:
        return key, robot
    try:
        require_chunk(named)
    except ValueError as error:
        raise UnknownKeyError(f"{key}: {error}") from error
    if robot not in (None, named):
        raise UnknownKeyError(f"{key} is of {named}, and {said} {robot}: leave out one of them")
    return below, named


def all_below_robot(keys: Iterable[str], robot: str | None, said: str = "--robot says") -> tuple[list[str], str | None]:
    """Do what `below_robot` does for several keys, which must be of one robot. Raises UnknownKeyError."""
    below = []
    for key in keys:
        short, named = below_robot(key, robot, said)
        below.append(short)
        if robot is None and named is not None:
            robot, said = named, f"{key} of"
    return below, robot


def find_heard_topic(key: str) -> Topic[Any]:
    """As `find_topic`, of what a tool may listen to, which is any key. Raises UnknownKeyError.

    Pictures are left out: nobody would be told who sees one that was not asked for.
    """
    if topic_of(key) in CAMERA_PICTURES:
        raise UnknownKeyError(f"{key}: pictures must be asked for: giraff camera view, giraff record --camera")
    if topic_of(key) is not None or _is_asked(key):
        return find_topic(key)
    try:
        zenoh.KeyExpr(f"{ROOT}/robot/{key}")
    except zenoh.ZError as error:
        raise UnknownKeyError(
            f"{key!r} is no key: give one like odom or maker/arm, of chunks with / between"
        ) from error
    return Topic(key, Sample, 0.0, "state")


def find_published_topic(key: str) -> Topic[Any]:
    """As `find_heard_topic`, of one key that a sample can go to. Raises UnknownKeyError."""
    if "*" in key:
        raise UnknownKeyError(f"{key}: a sample goes to one key; name what `*` stands for")
    topic = find_topic(key) if topic_of(key) in CAMERA_PICTURES else find_heard_topic(key)
    if topic_of(key) is None and any(intersects(row.key, key) for row in TOPICS):
        # A listener to `cmd_vel/*` hears it.
        raise UnknownKeyError(f"{key}: `*` of the table stands for letters, digits, '-' and '_'")
    return topic


def is_declared(topic: Topic[Any]) -> bool:
    """Tell whether the topics table has its key. A maker's own key carries what only its payload tells."""
    return topic_of(topic.key) is not None


def no_such_key(key: str, there: Iterable[str]) -> str:
    """What to say of a key that is none of these."""
    known = list(dict.fromkeys(there))
    return f"there is no key {key!r}; {meant(key, known)}there are: {', '.join(known)}"


def intersects(pattern: str, key: str) -> bool:
    """Whether what is said on `key` is heard by who listens to `pattern`; both may have a `*`."""
    ours, theirs = pattern.split("/"), key.split("/")
    return len(ours) == len(theirs) and all("*" in (a, b) or a == b for a, b in zip(ours, theirs, strict=True))


def is_live(services: Iterable[str]) -> bool:
    """Whether a robot of which these services are on the network is more than a recording that is played."""
    return any(service != PLAY.name for service in services)


def publish_refusal(topic: Topic[Any], live: Mapping[str, Iterable[str]]) -> str:
    """Why a tool may not publish a topic in the name of a robot; empty: it may.

    `live`: by service that is on the network, the keys that it publishes. What moves a robot, what it decides by and
    what it says of itself is its own, whether or not the service that says so is there just now.
    """
    if not is_live(live):
        return ""
    there = ", ".join(sorted(live))
    row = topic_of(topic.key) or topic
    if row.key in _COMMANDS:
        return (
            f"{topic.key} drives, and the robot is there ({there}): only an operator may; "
            "a program of yours is one with giraff_client"
        )
    if row == CAMERA_ON:
        return f"{topic.key} asks for a picture, and the robot is there ({there}): giraff camera view asks for it"
    speakers = sorted(service for service, keys in live.items() if any(intersects(key, topic.key) for key in keys))
    if speakers or row.key in _ROBOTS_OWN:
        says = f"is said by {', '.join(speakers)}" if speakers else "is the robot's own word"
        return f"{topic.key} {says}, and the robot is there ({there}): publish it under another name, --robot NAME"
    return ""
