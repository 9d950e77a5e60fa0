"""Base as a process, without a board: what the emergency stop is after base was killed and started again."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest
import zenoh

from giraff_cli.run.processes import ProcessGroup
from giraff_core.estop.latch import RELEASED, load_latch
from giraff_core.network import NetworkConfig
from giraff_node.network.query_client import QueryClient
from giraff_node.network.session import close_session, open_session
from giraff_node.process.state import Folder, write_latch
from giraff_schemas.health import Health
from giraff_schemas.messages import EStop, RobotTime, Sample, Tick
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import (
    ESTOP,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    TICK,
    AnswerT,
    Query,
    RequestT,
    Topic,
    health_key,
    key_of,
)
from giraff_schemas.trouble import Trouble
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.support.waiting import wait

NAME = "sim-estop"


class Base:
    """One base after the other, on a network of their own, with state in one place."""

    def __init__(self, directory: Path) -> None:
        self.state = directory / "state"
        network = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
        self._environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_ROBOT_NAME": NAME,
            "GIRAFF_NETWORK_LOCAL": "true",
            "GIRAFF_NETWORK_RENDEZVOUS": network.rendezvous,
            "GIRAFF_BASE_PORT": str(directory / "no-board"),
            "STATE_DIRECTORY": f"{self.state}:{directory}",
        }
        self._children = ProcessGroup(directory)
        self.session = open_session(network, NAME, "door")
        self._newest: dict[str, Sample] = {}
        self._subscribers = [self._listen(TICK), self._listen(ESTOP)]

    def start(self) -> EStop:
        """Start; the emergency stop it tells of."""
        self._newest.clear()
        self._children.start("base", "giraff_node", ("base",), self._environment)
        self.wait(lambda: {TICK.key, ESTOP.key} <= self._newest.keys())
        return self.estop

    def kill(self) -> None:
        os.kill(self._children.pid("base"), signal.SIGKILL)
        self.wait(lambda: bool(self._children.reap()))

    def close(self) -> None:
        self._subscribers.clear()
        close_session(self.session)
        assert self._children.stop_all(grace=60.0) == []

    @property
    def estop(self) -> EStop:
        newest = self._newest[ESTOP.key]
        assert isinstance(newest, EStop)
        return newest

    def engage(self) -> EStopAnswer:
        return self._ask(ESTOP_ENGAGE, EStopEngage(by="test", reason=Trouble("a shout")))

    def reset(self) -> EStopAnswer:
        newest = self._newest[TICK.key]
        assert isinstance(newest, Tick)
        return self._ask(ESTOP_RESET, EStopReset(by="test", id=self.estop.id, tick=newest.time))

    def health(self) -> Health:
        (reply,) = self.session.get(health_key(NAME, "base"), timeout=60.0)
        assert reply.ok is not None
        return msgspec.msgpack.decode(bytes(reply.ok.payload), type=Health)

    def wait(self, holds: Callable[[], bool]) -> None:
        wait(holds, 60.0)

    def _ask(self, query: Query[RequestT, AnswerT], request: RequestT) -> AnswerT:
        asking = QueryClient(self.session, NAME, query, request)
        answers: list[AnswerT] = []

        def answered() -> bool:
            answer = asking.poll(time.monotonic())
            answers.extend([answer] if answer is not None else [])
            return bool(answers)

        self.wait(answered)
        return answers[0]

    def _listen(self, topic: Topic[Tick] | Topic[EStop]) -> "zenoh.Subscriber[None]":
        def on_sample(received: zenoh.Sample) -> None:
            self._newest[topic.key] = msgspec.msgpack.decode(bytes(received.payload), type=topic.schema)

        return self.session.declare_subscriber(key_of(NAME, topic), on_sample)


@pytest.fixture
def base(tmp_path: Path) -> Iterator[Base]:
    base = Base(tmp_path)
    try:
        yield base
    finally:
        base.close()


def test_the_latch_outlives_base_and_so_does_a_reset(base: Base) -> None:
    write_latch(base.state, RELEASED)
    assert not base.start().engaged
    answer = base.engage()
    assert (answer.done, answer.engaged) == (True, True)
    base.kill()
    assert load_latch(Folder(base.state), 1).id == answer.id
    again = base.start()
    assert (again.engaged, again.id, again.by) == (True, answer.id, "test")
    old = EStopReset(by="test", id=again.id, tick=RobotTime(epoch=1, robot_ns=0))
    assert not base._ask(ESTOP_RESET, old).done
    assert base.reset().done
    base.kill()
    assert not load_latch(Folder(base.state), 1).engaged
    assert not base.start().engaged


def test_a_first_start_is_engaged_and_says_how_to_go_on(base: Base) -> None:
    estop = base.start()
    assert (estop.engaged, estop.by) == (True, "base")
    assert "estop.json is missing" in str(estop.reason)
    assert estop.reason.action == "release"
    assert base.reset().done


def test_state_that_cannot_be_written_is_told_and_nothing_is_released(base: Base) -> None:
    base.state.write_text("a file where the directory belongs")
    assert base.start().engaged
    base.wait(lambda: any("cannot be kept" in str(fault) for fault in base.health().faults))
    engaged = base.engage()
    assert (engaged.done, engaged.engaged) == (False, True)
    assert str(base.state) in str(engaged.reason)
    base.wait(lambda: base.estop.by == "test")
    reset = base.reset()
    assert (reset.done, reset.engaged) == (False, True)
    assert base.estop.engaged
