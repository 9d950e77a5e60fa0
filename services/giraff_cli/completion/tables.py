"""What a robot has by the tables of this program, for a shell that no robot answers. No network."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any

from giraff_core.tuning import Tuning, live_fields
from giraff_schemas.services import ANSWERING, SERVICES
from giraff_schemas.topics import CAMERA_PICTURES, TOPICS


def known(source: str, word: str) -> list[str]:
    """Return all of a source: robots, services, topics, published, or params of the service that `word` begins with."""
    service, dot, _ = word.partition(".")
    match source:
        case "robots":
            return _robots()
        case "services":
            return [each.name for each in SERVICES]
        case "params" if dot and service in ANSWERING:
            return [f"{service}.{name}" for name in live_fields(_config(service))]
        case "params":
            return sorted(ANSWERING)
        case _:
            return [topic.key for topic in TOPICS if topic not in CAMERA_PICTURES]


def narrowed(source: str, found: Iterable[str], word: str, verb: str) -> list[str]:
    """Return what of it the verb takes. Parameters come by their services first, which end in a dot."""
    if source != "params":
        return [*found]
    if "." not in word:
        return sorted({f"{each.partition('.')[0]}." for each in found})
    service = word.partition(".")[0]
    settable = verb != "set" or service not in ANSWERING
    live = {} if settable else live_fields(_config(service))
    fixed = {f"{service}.{name}" for name, tuning in live.items() if tuning in {None, Tuning.READ_ONLY}}
    return [each for each in found if each not in fixed]


def _config(service: str) -> Any:
    """Return the class of its table in the robot file."""
    return getattr(import_module(f"giraff_{service}.config"), f"{service.capitalize()}Config")


def _robots() -> list[str]:
    """Return the one that robot file or environment name."""
    from giraff_node.network.discovery import resolve_target  # noqa: PLC0415

    way = resolve_target(None, ())
    return [name for name in (way.robot or way.filed,) if name]
