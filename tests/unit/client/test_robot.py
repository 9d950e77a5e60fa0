"""`Robot` where the network fails it."""

from __future__ import annotations

from typing import Any, Never

import pytest
import zenoh

import giraff_client.robot
from giraff_client import NoRobotError, Robot


class FailingSession:
    """Of Zenoh, which opens and then takes no subscriber."""

    def declare_subscriber(self, *_: Any) -> Never:
        raise zenoh.ZError("the session is closed")


def test_a_session_that_fails_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    session = FailingSession()
    left: list[object] = []
    monkeypatch.setattr(giraff_client.robot, "open_session", lambda *_, **__: session)
    monkeypatch.setattr(giraff_client.robot, "close_session", left.append)
    with pytest.raises(NoRobotError, match=r"check the table \[network\]"), Robot("sim-test"):
        pass
    assert left == [session]
