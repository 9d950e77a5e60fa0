"""The flight recorder asks all services how they are, and hears each of them each time."""

from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import pytest

from giraff_recorder.config import RecorderConfig
from giraff_recorder.main import Others
from giraff_recorder.policy import IncidentDetector
from giraff_schemas.codec import encode
from giraff_schemas.health import Health
from giraff_schemas.topics import health_key
from giraff_schemas.trouble import Trouble
from tests.support.one_process import Clock, Session

SERVICES = ("base", "ranger", "guard", "odometry", "motion", "door")


@pytest.mark.parametrize("unwell", SERVICES)
def test_a_fault_that_any_of_six_services_finds_after_the_first_answers_is_an_incident(unwell: str) -> None:
    clock, incidents, faults = Clock(), IncidentDetector(RecorderConfig()), dict[str, tuple[Trouble, ...]]()
    session = Session(clock)

    def answer(service: str, _: bytes) -> tuple[float, bytes]:
        told = faults.get(service, ())
        health = Health(service=service, instance="i", host="h", pid=1, uptime=1.0, ok=not told, faults=told)
        return 0.02, encode(health)

    for service in SERVICES:
        session.answer(health_key("otto", service), partial(answer, service))
    node = SimpleNamespace(session=session, robot=SimpleNamespace(name="otto"), log=SimpleNamespace(warning=None))
    others = Others(cast(Any, node))
    for tenth in range(60):
        if tenth == 40:
            faults[unwell] = (Trouble("no such port"),)
        others.dispatch(incidents, clock.monotonic(), ask=tenth % 50 == 0)
        clock.sleep(0.1)
    incident = incidents.due(clock.monotonic() + 5.0)
    assert incident is not None
    assert incident.text == f"{unwell}: no such port"
