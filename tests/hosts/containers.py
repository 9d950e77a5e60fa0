"""A container as its host's Docker tells of it, in the lab's own time."""

import re
import time
from datetime import datetime
from typing import Any

import msgspec


class Container(msgspec.Struct, frozen=True):
    """As its host's Docker tells of it."""

    name: str
    service: str
    started_at: str
    """As Docker writes it: another one after a restart."""
    started: float
    """s of time.monotonic(), as below."""
    well_since: float | None
    """When its healthcheck first passed, where it has one; None: it is not healthy, or does not run."""


def container(told: dict[str, Any]) -> Container:
    """From what `docker inspect` tells of it."""
    state = told["State"]
    started = _moment(state["StartedAt"])
    checks = state.get("Health", {"Status": "healthy", "Log": []})
    passed = [_moment(check["End"]) for check in checks["Log"] or () if check["ExitCode"] == 0]
    is_well = state["Status"] == "running" and checks["Status"] == "healthy"
    return Container(
        name=told["Id"],
        service=told["Config"]["Labels"]["com.docker.compose.service"],
        started_at=state["StartedAt"],
        started=started,
        well_since=min(passed, default=started) if is_well else None,
    )


def _moment(written: str) -> float:
    """A time as Docker writes it, to the nanosecond; s of time.monotonic()."""
    moment = re.sub(r"(\.\d{6})\d*", r"\1", written)
    return datetime.fromisoformat(moment).timestamp() - time.time() + time.monotonic()
