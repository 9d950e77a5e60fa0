"""A service that hears nothing of its robot names the robots that are there, once."""

from collections.abc import Iterator
from contextlib import ExitStack
from typing import cast

import pytest
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network import base_reach
from giraff_node.network.base_reach import WrongRobotCheck
from giraff_schemas.topics import alive_key
from tests.support.one_process import Clock, Session


@pytest.mark.parametrize(
    ("own", "there", "told"),
    [
        (("odometry/me",), ("sim-vm/base/1", "giraff/odometry/me"), ("sim-vm",)),
        (("odometry/me", "recorder/1"), ("sim-vm/base/1",), ("sim-vm",)),
        (("odometry/me", "base/1"), ("sim-vm/base/1",), ()),
        (("odometry/me", "odometry/1"), ("sim-vm/base/1",), ()),
        (("odometry/me",), ("giraff/odometry/me",), ()),
    ],
)
def test_the_robots_that_are_there_are_named_once(
    monkeypatch: pytest.MonkeyPatch, own: tuple[str, ...], there: tuple[str, ...], told: tuple[str, ...]
) -> None:
    ours, door = Session(Clock()), Session(Clock())

    def doors(_: NetworkConfig, robot: str) -> Iterator[tuple[str, zenoh.Session]]:
        assert robot == "giraff"
        yield "", cast(zenoh.Session, door)

    monkeypatch.setattr(base_reach, "open_clients", doors)
    monkeypatch.setattr(base_reach, "close_session", lambda _: True)
    with ExitStack() as tokens:
        for each in own:
            tokens.enter_context(ours.declare_token(alive_key("giraff", *each.split("/"))))
        for each in there:
            tokens.enter_context(door.declare_token(alive_key(*each.split("/"))))
        check = WrongRobotCheck(cast(zenoh.Session, ours), NetworkConfig(), "giraff", "me")
        assert [check.others(now) for now in (0.0, 4.9)] == [(), ()], "a robot's services start one after another"
        found = []
        for now in (5.0, 6.0, 100.0):
            found.append(check.others(now))
            assert check._thread is not None
            check._thread.join()
    assert [each for each in found if each] == [told] * bool(told)
