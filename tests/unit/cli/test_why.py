"""`giraff why` asks all services how they are, and those by name that do not answer, before it says that one hangs."""

from contextlib import ExitStack

import pytest

from giraff_cli.why import explain
from giraff_cli.why.chain import ChainState
from giraff_core.network import NetworkConfig
from giraff_node.process.version import version
from giraff_schemas.codec import encode
from giraff_schemas.health import Health
from giraff_schemas.topics import alive_key, health_key
from giraff_schemas.trouble import Trouble
from tests.unit.cli.asked import AskedRobot

ROBOT = "sim-why"
SERVICES = ("base", "ranger", "guard", "odometry", "motion", "door")
UNPLUGGED = "no such port; plug the board in"


class Network(AskedRobot):
    """A robot of six services that say nothing by themselves. Each answers about its health, if it is asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(ROBOT, NetworkConfig(connect=("192.168.1.20",), local=True))
        self.after: dict[str, float] = {}
        """By service, s until it answers."""
        self.faults: dict[str, tuple[str, ...]] = {}
        self.mute: set[str] = set()
        monkeypatch.setattr(explain, "time", self.clock)
        monkeypatch.setattr(explain, "robot_now_ns", self.clock.monotonic_ns)
        self.tokens = ExitStack()
        for service in SERVICES:
            self.begin(service)

    def begin(self, service: str) -> None:
        def answer(_: bytes) -> tuple[float, bytes] | None:
            faults = tuple(map(Trouble, self.faults.get(service, ())))
            health = Health(
                service=service,
                instance=service,
                host="h",
                pid=1,
                uptime=1.0,
                ok=not faults,
                faults=faults,
                version=version(),
            )
            return None if service in self.mute else (self.after.get(service, 0.02), encode(health))

        self.session.answer(health_key(ROBOT, service), answer)
        self.tokens.enter_context(self.session.declare_token(alive_key(ROBOT, service, service)))

    def told(self, service: str, seconds: float = 1.0) -> str:
        """Return what `why` says of a service that sends nothing."""
        link = ChainState(explain.listen(self.connection, seconds)).silent(service, service)
        return link.text.removeprefix(f"giraff_{service}: ")


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    return Network(monkeypatch)


@pytest.mark.parametrize("service", SERVICES)
def test_each_of_six_services_is_heard_in_the_time_given(network: Network, service: str) -> None:
    network.faults[service] = (UNPLUGGED,)
    assert network.told(service) == UNPLUGGED
    assert network.clock.monotonic() == pytest.approx(1.05, abs=0.01)  # with the wait for the first word


def test_one_that_does_not_answer_to_its_own_name_hangs_and_no_other(network: Network) -> None:
    network.mute.add("ranger")
    network.faults["guard"] = (UNPLUGGED,)
    assert network.told("guard") == UNPLUGGED
    assert network.told("ranger").endswith("does not answer; it hangs: restart it")
    assert "hangs" not in network.told("motion")


@pytest.mark.parametrize("after", [0.9, 1.4])
def test_one_whose_answer_is_late_is_waited_for(network: Network, after: float) -> None:
    network.after["ranger"] = after
    network.faults["ranger"] = (UNPLUGGED,)
    assert network.told("ranger") == UNPLUGGED


def test_one_that_came_too_late_to_be_asked_in_time_does_not_hang(network: Network) -> None:
    network.mute |= {"ranger", "joystick"}
    network.clock.after(1.5, lambda: network.begin("joystick"))
    assert network.told("joystick").endswith("has not answered yet; ask again")


def test_one_that_was_not_heard_by_all_is_asked_by_its_name(network: Network) -> None:
    network.mute.add("ranger")
    network.faults["ranger"] = (UNPLUGGED,)
    network.clock.after(0.3, network.mute.clear)
    assert network.told("ranger") == UNPLUGGED
    assert network.clock.monotonic() == pytest.approx(1.05, abs=0.01)


def test_one_that_is_well_and_sends_nothing_does_not_hang_by_its_answer(network: Network) -> None:
    assert network.told("guard").startswith("answers that it is well, and sends nothing")
