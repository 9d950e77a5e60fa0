"""One lab for all tests of this folder, which takes longer to make than any of them; and what comes up in it first."""

from collections.abc import Iterator

import pytest

from tests.hosts.deploy_page import type_the_page
from tests.hosts.hardware import PORTS, permit
from tests.hosts.images import Images
from tests.hosts.lab import NUMBERS, Lab
from tests.unit.node.ports import FakePort

IMAGES = {"laptop": ("laptop",), "robot": ("robot", "laptop", "recorder", "web"), "desk": ("laptop", "sim")}
"""The robot's computer has the command line, too, as docs/deploy.md has it for one that may lose its network."""
EXTRAS = {"COMPOSE_PROFILES": "robot,recorder,gateway,web"}
SETTINGS = {
    "GIRAFF_RECORDER_BEFORE": "8",
    "GIRAFF_RECORDER_AFTER": "1",
    "GIRAFF_GATEWAY_PORT": str(PORTS / "weather"),
    "GIRAFF_GATEWAY_NAME": "weather",
}


@pytest.fixture(scope="session", autouse=True)
def images(request: pytest.FixtureRequest) -> Iterator[Images]:
    """They are built from the start, while tests run that need no lab."""
    images = Images()
    try:
        if any("lab" in item.fixturenames for item in request.session.items if isinstance(item, pytest.Function)):
            images.build(kind for each in IMAGES.values() for kind in each)
        yield images
    finally:
        images.close()


@pytest.fixture(scope="session")
def lab(images: Images) -> Iterator[Lab]:
    """Three hosts, without a container yet."""
    lab = Lab(IMAGES, images)
    try:
        yield lab
    finally:
        lab.close()


@pytest.fixture(scope="session")
def arduino(lab: Lab) -> Iterator[FakePort]:
    """It is plugged into the robot's computer."""
    port = FakePort(PORTS / "weather")
    permit(port.link)
    yield port
    port.close()
    del lab


@pytest.fixture(scope="session")
def up(lab: Lab, arduino: FakePort) -> None:
    """All three, by docs/deploy.md; beside the robot's services recorder, the Arduino's gateway and the page."""
    type_the_page(lab, {"robot": lambda: lab.write_env("robot", EXTRAS, SETTINGS)})
    lab.wait_until_healthy(*NUMBERS)
    del arduino


@pytest.fixture(autouse=True)
def _mended(request: pytest.FixtureRequest) -> Iterator[None]:
    yield
    if "lab" in request.fixturenames:
        request.getfixturevalue("lab").mend()
