"""How soon three hosts are driven on networks without multicast, and with certificates."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import pytest

from tests.hosts.lab import NUMBERS, Lab, address
from tests.hosts.secured import known_as, make_keys, open_again, secure
from tests.support.waiting import wait

Figure = Callable[[str, float, float, str], None]

pytestmark = pytest.mark.timeout(600)

ORDERS: Final = [("desk", "laptop", "robot"), ("robot", "laptop", "desk")]


@pytest.fixture(scope="module")
def released(lab: Lab) -> None:
    """The emergency stop is reset, and nothing is up."""
    lab.on_each(NUMBERS, lab.up)
    lab.wait_until_healthy(*NUMBERS)
    lab.reset_emergency_stop()
    lab.down(*NUMBERS)


@pytest.fixture(scope="module")
def keys(lab: Lab) -> Path:
    """The technician's folder."""
    return make_keys(lab)


@pytest.fixture(scope="module")
def secured(lab: Lab, released: None, keys: Path) -> Iterator[None]:  # noqa: ARG001
    """All three are up with their certificates."""
    lab.down(*NUMBERS)
    secure(lab, keys)
    lab.on_each(NUMBERS, lab.up)
    lab.wait_until_healthy(*NUMBERS)
    yield
    lab.down(*NUMBERS)
    open_again(lab)


@pytest.mark.usefixtures("released")
@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_up_one_after_another_without_multicast(lab: Lab, order: tuple[str, ...], figure: Figure) -> None:
    lab.down(*NUMBERS)
    lab.do_without_multicast("fixed")
    last = 0.0
    for host in order:
        last = lab.up(host)
        time.sleep(1.0)
    network = {"mode": "fixed", "connect": [address("robot")]}
    with lab.listen("desk", "odom", network=network) as desk:
        wait(lambda: bool(desk.heard()), 30.0, what="odometry on the desk")
        lab.hardware.drive()
        figure(f"up as {', '.join(order)}, without multicast -> driven", time.monotonic() - last, 20.0, "s")


@pytest.mark.usefixtures("secured")
def test_driven_with_certificates(lab: Lab, figure: Figure) -> None:
    figure("with certificates: level hand, then a tilt -> wheels turn", lab.hardware.drive(), 10.0, "s")


@pytest.mark.usefixtures("secured")
@pytest.mark.parametrize("seconds", [1.0, 5.0])
def test_a_cut_cable_with_certificates(lab: Lab, keys: Path, seconds: float, figure: Figure) -> None:
    with lab.listen("laptop", "odom", network=known_as(keys, "laptop")) as laptop:
        wait(lambda: bool(laptop.heard()), 10.0, what="odometry on the laptop")
        lab.hardware.drive()
        lab.switch.cut(lab.machines["laptop"])
        time.sleep(seconds)
        lab.switch.join(lab.machines["laptop"])
        flows = laptop.flows_after(time.monotonic(), 20.0)
    figure(f"with certificates: cable back after {seconds:g} s -> samples flow", flows, 2.0, "s")
    lab.hardware.drive()
