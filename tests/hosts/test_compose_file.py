"""The compose file and each host's example .env, read by docker-compose 1.29 and by current Compose."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from giraff_schemas.services import ROLES
from tests.hosts.clone import clone, write_env
from tests.hosts.images import CURRENT_COMPOSE
from tests.hosts.machine import BIN

COMPOSE = {"1.29": "/usr/bin/docker-compose", "current": str(CURRENT_COMPOSE)}
UP = {
    "robot": set(ROLES["robot"]),
    "laptop": {"joystick", "watch"},
    "desk": {"watch"},
    "sim": {"sim"},
    "router": {"router"},
}
"""Kind of host -> what plain `docker-compose up` starts there."""


def compose(generation: str, place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [COMPOSE[generation], *words],
        cwd=place,
        env={"PATH": BIN, "HOME": os.environ.get("HOME", "/")},
        check=False,
        capture_output=True,
        text=True,
        timeout=60.0,
    )


@pytest.fixture(params=COMPOSE)
def generation(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("clone") / "giraff"
    clone(place)
    return place


@pytest.mark.parametrize("kind", UP)
def test_the_file_is_clean(generation: str, place: Path, kind: str) -> None:
    write_env(place, kind, {})
    done = compose(generation, place, "config", "--services")
    assert (done.returncode, done.stderr) == (0, "")
    # 1.29 lists every service, whatever the profile.
    listed = set(done.stdout.split())
    assert listed >= UP[kind]
    assert generation == "1.29" or listed == UP[kind]


@pytest.mark.parametrize("kind", UP)
def test_nothing_is_up_that_should_not_be(place: Path, kind: str) -> None:
    write_env(place, kind, {})
    services = config("current", place)["services"]
    assert set(services) == UP[kind]
    for service in services.values():
        assert service["network_mode"] == "host"
        assert service["read_only"] is True
        assert service["cap_drop"] == ["ALL"]
        assert service["security_opt"] == ["no-new-privileges:true"]
        assert not {"privileged", "cap_add", "devices", "ports"} & set(service)


def test_what_the_env_says_reaches_the_service(generation: str, place: Path) -> None:
    write_env(place, "laptop", {"GIRAFF_NETWORK_CONNECT": '["192.168.1.20"]', "GIRAFF_ROBOT_NAME": "anna"})
    environment = config(generation, place)["services"]["joystick"]["environment"]
    assert environment["GIRAFF_NETWORK_CONNECT"] == '["192.168.1.20"]'
    assert environment["GIRAFF_ROBOT_NAME"] == "anna"


def test_without_an_env_nothing_starts(generation: str, place: Path) -> None:
    (place / ".env").unlink(missing_ok=True)
    done = compose(generation, place, "--profile", "robot", "config")
    assert done.returncode != 0
    assert ".env" in done.stderr


def config(generation: str, place: Path) -> dict[str, Any]:
    """As Compose understands it; 1.29 writes YAML only, which `docker-compose` of any generation reads."""
    done = compose(generation, place, "config")
    assert done.returncode == 0, done.stderr
    if generation == "current":
        done = compose(generation, place, "config", "--format", "json")
    else:
        resolved = place / "resolved.yml"
        resolved.write_text(done.stdout)
        done = compose("current", place, "--file", str(resolved), "config", "--format", "json")
    told: dict[str, Any] = json.loads(done.stdout)
    return told
