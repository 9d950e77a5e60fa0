"""How a service is: its own faults, and what it notices."""

import msgspec

from giraff_node.process.health import HealthState
from giraff_node.process.logs import service_logger
from giraff_schemas.health import Health
from giraff_schemas.trouble import NO_TROUBLE, Trouble

NO_ROBOT = Trouble("no robot is heard", "start one", "run", "giraff run")


def test_a_condition_is_its_own_faults_and_what_it_notices() -> None:
    condition = HealthState("base", "1", service_logger("base"))
    assert condition.summary == "well"
    condition.set_notice("link", NO_ROBOT)
    assert condition.health().ok
    assert condition.health().notices == (NO_ROBOT,)
    condition.set_fault("board", Trouble("unplugged"))
    condition.set_fault("disk", Trouble("full"))
    assert not condition.health().ok
    assert condition.health().faults == (Trouble("unplugged"), Trouble("full"))
    assert condition.summary == f"unplugged; full; {NO_ROBOT}"
    condition.set_fault("board", NO_TROUBLE)
    condition.set_fault("disk", NO_TROUBLE)
    condition.set_notice("link", NO_TROUBLE)
    assert condition.health().ok
    assert condition.summary == "well"


def test_a_fault_that_is_no_text_is_told_all_the_same() -> None:
    condition = HealthState("base", "1", service_logger("base"))
    condition.set_fault("board", Trouble("/dev/\udcff: no such port"))
    [fault] = msgspec.json.decode(msgspec.json.encode(condition.health()), type=Health).faults
    assert fault == Trouble("/dev/?: no such port")
