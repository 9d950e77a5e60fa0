from __future__ import annotations

import socket

import msgspec
import pytest

from giraff_schemas.health import Health
from giraff_schemas.trouble import WELL, Trouble, read_trouble


@pytest.mark.parametrize("trouble", [WELL, Trouble("it is dark"), Trouble("it is dark; and cold", "light a fire")])
def test_a_line_and_its_remedy_are_read_as_they_were_made(trouble: Trouble) -> None:
    assert read_trouble(str(trouble), trouble.remedy) == trouble


@pytest.mark.parametrize("line", ["it is dark", "light a fire", "; light a fire", "it is darklight a fire"])
def test_a_remedy_that_is_not_the_tail_of_the_line_is_not_believed(line: str) -> None:
    assert read_trouble(line, "light a fire") == Trouble(line)


def test_an_earlier_version_tells_no_remedies() -> None:
    told = {"service": "base", "instance": "a", "host": socket.gethostname(), "pid": 1, "uptime": 1.0, "ok": False}
    health = Health(**told, faults=("it is dark; light a fire", "cold"))  # type: ignore[arg-type]  # as named above
    assert health.troubles == (Trouble("it is dark; light a fire"), Trouble("cold"))
    assert msgspec.structs.replace(health, fault_remedies=("light a fire", "", "more")).troubles == (
        Trouble("it is dark", "light a fire"),
        Trouble("cold"),
    )
