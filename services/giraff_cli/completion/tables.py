"""What a robot has by the tables of this program, for a shell that no robot answers. No network."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any

from giraff_core.tuning import Tuning, live_fields
from giraff_schemas.services import ANSWERING, SERVICES
from giraff_schemas.topics import CAMERA_PICTURES, TOPICS


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
