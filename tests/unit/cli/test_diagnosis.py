"""`giraff why`: for each thing that can stop a robot, the link that is to blame is named, and no other."""

from collections.abc import Iterable
from typing import Any

import msgspec
import pytest

from giraff_cli.why.chain import Observation
from giraff_cli.why.explain import LINKS, _show, diagnose
from giraff_core.lease import IDLE
from giraff_schemas import topics
from giraff_schemas.actions import ANY, TILT
from giraff_schemas.codec import stamped
from giraff_schemas.health import other_health
from giraff_schemas.places import NO_ROUTE
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.support.motion_double import route_state
from tests.unit.cli.samples import MS, attitude, base, camera, estop, lease, reading, verdict
from tests.unit.cli.scenes import CAUSES, HAND, NOW, Scene, blocked, command, fault, state


@pytest.mark.parametrize("cause", CAUSES)
def test_the_link_to_blame_is_named_with_the_way_out_and_no_other(cause: str) -> None:
    change, link, told = CAUSES[cause]
    chain = Scene()
    change(chain)
    diagnosis = chain.diagnosis()
    assert diagnosis.stopped_by == link, shown(diagnosis.links)
    assert diagnosis.conclusion.startswith(f"{link}: ")
    assert told in diagnosis.conclusion
    assert [each.name for each in diagnosis.links if each.breaks] == [link], shown(diagnosis.links)


def shown(links: Iterable[Any]) -> str:
    return "\n".join(f"{link.name} {link.standing} {link.text}" for link in links)


def test_with_nothing_wrong_nothing_is_found() -> None:
    diagnosis = Scene().diagnosis()
    assert tuple(link.name for link in diagnosis.links) == tuple(name for name in LINKS if name != "scan")
    assert {link.status for link in diagnosis.links} == {"ok"}
    assert (diagnosis.stopped_by, diagnosis.drives) == ("", False)
    assert diagnosis.conclusion == "nothing stops the robot: it drives when the hand asks for it"


def idle(chain: Scene) -> Scene:
    """Nobody holds the lease, and nothing is wrong."""
    chain.put(topics.LEASE, msgspec.structs.replace(lease("", ""), reason=IDLE), "g")
    chain.put(topics.GUARD, state(reason=IDLE), "g")
    chain.put(topics.BASE, msgspec.structs.replace(base(armed=False), reason=IDLE), "b")
    return chain


def test_a_robot_that_nobody_asks_to_drive_is_idle_and_one_link_says_so() -> None:
    diagnosis = idle(Scene()).diagnosis()
    assert (diagnosis.stopped_by, diagnosis.conclusion) == ("", IDLE.line(TILT))
    links = {link.name: (link.status, link.text) for link in diagnosis.links}
    assert links["lease"] == ("idle", IDLE.line(TILT))
    assert links["guard"] == ("ok", "no direction is blocked")
    assert links["base"] == ("idle", "see lease")


def test_an_idle_robot_that_base_forbids_to_move_is_stopped_by_base() -> None:
    empty = "the battery is empty at 9.6 V; charge it"
    chain = idle(Scene()).put(topics.BASE, base(armed=False, reason=empty), "b")
    assert chain.diagnosis().conclusion == f"base: {empty}"
    CAUSES["e-stop"][0](chain)
    chain.put(topics.LEASE, msgspec.structs.replace(lease("", ""), reason=IDLE), "g")
    assert chain.diagnosis().stopped_by == "e-stop"


def test_a_program_of_ros_that_does_not_count_is_told_beside_a_hand_that_rests() -> None:
    told = "giraff_ros2: messages on /cmd_vel count for nothing"
    diagnosis = idle(Scene()).complain("ros2", told.removeprefix("giraff_ros2: ")).diagnosis()
    assert (diagnosis.stopped_by, diagnosis.conclusion.startswith(IDLE.line(TILT))) == ("", True)
    assert diagnosis.conclusion.endswith(told)


def test_one_who_asks_and_holds_no_lease_is_not_idle() -> None:
    chain = idle(Scene()).put(topics.OPERATOR_CMD_VEL, command(0.3), HAND, "joystick")
    assert chain.diagnosis().stopped_by == "lease"


def test_what_waits_names_the_link_to_read() -> None:
    seen = blocked().reason.of("forward blocked")
    for cause, link, told in (("e-stop", "e-stop", NO_TROUBLE), ("obstacle", "guard", seen)):
        chain = Scene()
        CAUSES[cause][0](chain)
        chain.put(topics.BASE, base(armed=False, reason=told, latch="none"), "b")
        [waits] = [each for each in chain.diagnosis().links if each.status == "waits" and each.name == "base"]
        assert waits.text == f"see {link}"


def test_a_camera_that_is_on_is_no_fault() -> None:
    chain = Scene().put(topics.CAMERA_STATE, camera("ann@desk"), "c", "head")
    diagnosis = chain.diagnosis()
    assert diagnosis.cameras == ("camera head is seen by ann@desk",)
    assert diagnosis.conclusion == "nothing stops the robot: it drives when the hand asks for it"


def test_a_route_that_waits_or_has_not_arrived_is_told_while_the_robot_stands(capsys: Any) -> None:
    waits = route_state(1, "waiting", at=(4.1, 2.2), reason=Trouble("front_left sees something", "wait"))
    chain = Scene().put(topics.ROUTE, waits, "p")
    told = "to kitchen, waits in leg 2 of 5, 3.2 of 7.9 m: front_left sees something; wait (at 4.10,2.20 m)"
    assert (chain.diagnosis().stopped_by, chain.diagnosis().conclusion) == ("", f"route: {told}")
    _show(chain.diagnosis(), [])
    assert capsys.readouterr().out.count(told) == 1
    CAUSES["e-stop"][0](chain)
    _show(chain.diagnosis(), [])
    *_, above, last = capsys.readouterr().out.splitlines()
    assert (above, last.startswith("otto: e-stop: ")) == (f"route: {told}", True)
    chain = Scene()
    chain.put(topics.ROUTE, route_state(1, "ended", "forbidden", reason=Trouble("stairs is in the way")), "p")
    assert (
        chain.diagnosis().route == "last route: to kitchen, forbidden in leg 2 of 5, 3.2 of 7.9 m: stairs is in the way"
    )
    chain.put(topics.BASE, base(), "b")
    assert chain.diagnosis().route == "", "it drives"
    for well in (NO_ROUTE, route_state(1), route_state(1, "ended", "arrived")):
        assert Scene().put(topics.ROUTE, well, "p").diagnosis().route == ""


def test_the_wheels_of_a_robot_that_balances_are_told_with_how_it_holds_itself() -> None:
    chain = Scene().put(topics.ATTITUDE, attitude(0), "b")
    told = "motor commands of 0 and 0 of 255; stands: leans 1.5°, -12 N m"
    wheels = chain.diagnosis().links[-1]
    assert (wheels.status, wheels.text.endswith(told)) == ("ok", True), wheels.text
    chain.put(topics.ATTITUDE, attitude(0, "sits down", "the battery was low"), "b")
    wheels = chain.diagnosis().links[-1]
    assert (wheels.status, "sits down, because the battery was low" in wheels.text) == ("waits", True), wheels.text


def test_a_robot_that_drives_does() -> None:
    chain = Scene().put(topics.OPERATOR_CMD_VEL, command(0.3), HAND, "joystick")
    chain.put(topics.BASE, base(), "b")
    assert chain.diagnosis().drives
    assert chain.diagnosis().conclusion == "the robot drives"
    chain.put(topics.BASE, base(reason="slowed: the operator's commands come late"), "b")
    assert chain.diagnosis().conclusion == "the robot drives, but base: slowed: the operator's commands come late"


def test_what_base_notices_is_told_once_on_its_row_also_while_the_robot_stands() -> None:
    doubt = "the left wheel turns less than its motor drives it"
    chain = Scene().complain("base", doubt)
    assert chain.diagnosis().conclusion == f"nothing stops the robot, but base: armed; {doubt}"
    chain.put(topics.BASE, base(reason=f"slowed: {doubt}"), "b")
    assert chain.diagnosis().conclusion == f"the robot drives, but base: slowed: {doubt}"
    chain = idle(Scene()).complain("base", doubt)
    assert [each.text for each in chain.diagnosis().links if each.name == "base"] == [f"see lease; {doubt}"]


def test_what_is_in_the_way_of_a_level_hand_only_limits() -> None:
    chain = Scene().put(topics.GUARD, state(forward=blocked()), "g")
    diagnosis = chain.diagnosis()
    assert diagnosis.stopped_by == ""
    assert diagnosis.conclusion.startswith(
        "nothing stops the robot, but guard: forward blocked: front_left sees something at 0.31 m"
    )


def test_a_turn_is_judged_where_a_turn_is_asked_for() -> None:
    chain = Scene().put(topics.OPERATOR_CMD_VEL, command(angular=0.5), HAND, "joystick")
    chain.put(topics.GUARD, state(forward=blocked(), backward=blocked()), "g")
    assert chain.diagnosis().stopped_by == ""
    chain.put(topics.GUARD, state(turn_left=blocked()), "g")
    assert chain.diagnosis().conclusion.startswith("guard: turn left blocked")
    chain.put(topics.OPERATOR_CMD_VEL, command(angular=-0.5), HAND, "joystick")
    assert chain.diagnosis().stopped_by == ""


def test_what_only_creeps_says_why() -> None:
    chain = Scene()
    unproved = verdict(0.1, "creep", "rear", "rear has not proved that it hears", "face a wall")
    chain.put(topics.GUARD, state(backward=unproved), "g")
    limits = "guard: backward only creeps: rear has not proved that it hears; face a wall"
    assert chain.diagnosis().conclusion == f"nothing stops the robot, but {limits}"


def test_of_two_operators_the_holder_of_the_lease_counts() -> None:
    chain = Scene()
    other = msgspec.structs.replace(fault("the terminal is gone"), operator="keyboard")
    chain.put(topics.OPERATOR_CMD_VEL, other, "k", "keyboard")
    assert chain.diagnosis().stopped_by == ""
    chain.put(topics.LEASE, lease("k", "keyboard"), "g")
    assert chain.diagnosis().conclusion == "operator: keyboard: the terminal is gone"


def test_several_causes_are_told_from_the_hand_on() -> None:
    chain = Scene()
    for cause in ("stuck wheel", "obstacle", "laid down"):
        CAUSES[cause][0](chain)
    chain.put(topics.BASE, base(armed=False, latch="left_stuck"), "b")
    diagnosis = chain.diagnosis()
    assert diagnosis.stopped_by == "hand"
    assert diagnosis.conclusion.endswith("(then: board)")


def test_a_sample_of_long_ago_tells_nothing_of_now() -> None:
    observation = Observation("otto")
    observation.on_sample(topics.BASE, topics.BASE.key, stamped(base(), 0, 0, "b"), NOW)
    observation.now_ns = NOW + 400 * MS
    assert observation.newest(topics.BASE) is not None
    observation.now_ns = NOW + 600 * MS
    assert observation.newest(topics.BASE) is None


def test_a_reading_s_name_is_the_sensor_s() -> None:
    chain = Scene().put(topics.RANGE, reading("rear", None, "clear"), "r", "rear")
    [ranger] = [link for link in chain.diagnosis().links if link.name == "ranger"]
    assert ranger.text == "front_left 1.50 m, front_right 1.50 m, rear clear"


def test_two_versions_are_named_with_their_hosts() -> None:
    """Of an answer that only another version reads whole, who gives it is known all the same."""
    told = {"service": "base", "instance": "b", "host": "robot", "version": "0.2.0", "troubles": 7}
    health = other_health(msgspec.msgpack.encode(told))
    assert health is not None
    assert [fault.what for fault in health.faults] == ["it is of version 0.2.0"]
    observation = Observation("otto", "laptop", "0.1.0")
    assert diagnose(observation).versions == ""
    observation.health = [health]
    assert diagnose(observation).versions.startswith(
        "versions differ: 0.1.0 on laptop (this command); 0.2.0 on robot (base); install the same version"
    )
    assert other_health(b"\xc1") is None


def test_wiring_that_nobody_has_checked_is_told_once_with_its_command() -> None:
    unchecked = Trouble("the wiring is not checked", "lift the wheels", "run", "giraff check wheels")
    chain = Scene().put(topics.BASE, base(armed=False, reason=unchecked), "b").complain("base", unchecked)
    assert chain.diagnosis().conclusion == f"base: {unchecked}"


def test_a_hand_is_spoken_to_in_its_words_where_it_drives_or_is_alone() -> None:
    """The release is told as this command's reader can type it."""
    idle = Scene().put(topics.LEASE, msgspec.structs.replace(lease("", ""), reason=IDLE), "g")
    assert IDLE.to_do(TILT) in idle.diagnosis().conclusion
    other = msgspec.structs.replace(command(), operator="web", instance="page")
    idle.put(topics.OPERATOR_CMD_VEL, other, "page", "web")
    assert IDLE.to_do(ANY) in idle.diagnosis().conclusion
    idle.put(topics.LEASE, lease("page", "web"), "g").put(topics.ESTOP, estop(engaged=True), "b")
    assert "then run `giraff estop reset` to release it, then hold the page" in idle.diagnosis().conclusion
