"""A router that is lost, and a place that is lost to it."""

import time
from collections.abc import Iterator

import pytest

from giraff_schemas.topics import ODOM, key_of
from tests.support.fleet import ANNE, AWAY, BOB, CLINIC, HOME, JOYSTICK, Fleet, fleet


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Fleet]:
    with fleet(tmp_path_factory.mktemp("fleet")) as made:
        yield made


def test_a_site_that_vanishes_holds_up_nobody_else(world: Fleet) -> None:
    """Its links, each of them, are a while in closing: with Zenoh's own two threads all others stand still for 10 s."""
    alone = {"multicast": {"enabled": False}, "gossip": {"enabled": False}}  # each with one link, to the router
    crowd = world.behind.join("anne-pc", HOME, ANNE, scouting=alone)
    crowd.ask("crowd", "60", key_of(ANNE, JOYSTICK))
    bob, laptop = world.behind.join("bob-pc", CLINIC, BOB), world.of["laptop"]
    bobs_doctor = world.behind.join("doctor", AWAY, BOB)
    bobs_doctor.ask("subscribe", key_of(BOB, ODOM))

    def stream(seconds: float) -> float:
        """The longest gap while bob tells, and anne's many listeners are told, 50 times a second."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            bob.ask("put", "news", key_of(BOB, ODOM))
            laptop.ask("put", "news", key_of(ANNE, JOYSTICK))
            time.sleep(0.02)
        return float(bobs_doctor.ask("gap"))

    stream(2.0)
    before = stream(2.0)
    world.sites.pull(HOME)
    during = stream(8.0)
    world.sites.plug(HOME)
    print(f"longest gap {before:.2f} s before, {during:.2f} s while 60 links vanished")
    assert during <= 1.0
    crowd.end()
    world.all_meet()


def test_a_router_that_was_killed_is_back_within_five_seconds(world: Fleet) -> None:
    world.behind.kill_router()
    time.sleep(3.0)  # all have noticed, and try again
    world.behind.start_router()
    took = world.all_meet()
    print(f"heard each other again {took:.2f} s after the router was started")
    assert took <= 5.0
