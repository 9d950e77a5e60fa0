"""What a robot has, for a shell: by its own word, or by the tables of this program where no robot answers."""

import time
from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import Any

from giraff_core.tuning import Tuning, live_fields
from giraff_schemas.params import ParamAnswer, ParamDescribe
from giraff_schemas.services import ANSWERING, SERVICES
from giraff_schemas.topics import CAMERA_PICTURES, PARAM_DESCRIBE, ROOT, TOPICS, alive_key, health_key


def known(source: str, word: str) -> list[str]:
    """Return all of a source; of parameters those of the service that `word` begins with, or else the services."""
    service, dot, _ = word.partition(".")
    match source:
        case "robots":
            return _robots()
        case "services":
            return [each.name for each in SERVICES]
        case "params" | "settable" if dot and service in ANSWERING:
            fixed = {None, Tuning.READ_ONLY} if source == "settable" else ()
            return [f"{service}.{name}" for name, live in live_fields(_config(service)).items() if live not in fixed]
        case "params" | "settable":
            return sorted(ANSWERING)
        case _:
            return [topic.key for topic in TOPICS if topic not in CAMERA_PICTURES]


def by_service(source: str, found: Iterable[str], word: str) -> list[str]:
    """Return what was found; of parameters first the services, each with a dot, until one is typed."""
    if source not in {"params", "settable"} or "." in word:
        return [*found]
    return sorted({f"{each.partition('.')[0]}." for each in found})


def _config(service: str) -> Any:
    """Return the class of its table in the robot file."""
    return getattr(import_module(f"giraff_{service}.config"), f"{service.capitalize()}Config")


def _robots() -> list[str]:
    """Return the one that robot file or environment name."""
    from giraff_node.network.discovery import resolve_target  # noqa: PLC0415

    way = resolve_target(None, ())
    return [name for name in (way.robot or way.filed,) if name]


def asked(source: str, robot: str | None, connect: Sequence[str], word: str, deadline: float) -> list[str]:
    """Return robots, services, published topics or parameters. Raises what opening a session raises.

    Only a name that somebody has typed narrows it to one robot. The process ends without closing the session.
    """
    from giraff_node.network.discovery import resolve_target  # noqa: PLC0415  what the tables tell waits for no network
    from giraff_node.network.replies import gather_answers  # noqa: PLC0415
    from giraff_node.network.session import open_session  # noqa: PLC0415
    from giraff_node.network.tokens import find_tokens, list_robots  # noqa: PLC0415
    from giraff_schemas.codec import encode, encoding_of  # noqa: PLC0415
    from giraff_schemas.health import Health  # noqa: PLC0415

    way = resolve_target(robot, connect)
    session = open_session(way.network, way.robot or "*", "client")
    within = max(0.05, deadline - time.monotonic())
    if source == "robots":
        return list_robots(session)
    whose = way.robot if way.robot and not way.named_by else "*"
    if source == "services" or (source in {"params", "settable"} and "." not in word):
        services = [token.service for token in find_tokens(session, alive_key(whose), within)]
        return [each for each in services if source == "services" or each in ANSWERING]
    if source == "published":
        healths = gather_answers(session, health_key(whose), Health, within)
        return [key for health in healths for key in health.publishes]
    service = word.partition(".")[0]
    query = PARAM_DESCRIBE.at(service) if service in ANSWERING else PARAM_DESCRIBE
    at = f"{ROOT}/{whose}/{query.key}"
    request = {"payload": encode(ParamDescribe()), "encoding": encoding_of(ParamDescribe)}
    told = gather_answers(session, at, ParamAnswer, within, **request)
    return [
        param.name if param.name.startswith("robot.") else f"{answer.service}.{param.name}"
        for answer in told
        for param in answer.params
        if source == "params" or param.live != "fixed"
    ]
