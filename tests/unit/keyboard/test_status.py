"""What the person at the keyboard is shown."""

import msgspec

from giraff_keyboard.policy import Key
from giraff_keyboard.status import HELP, STALE, StatusView
from giraff_schemas.messages import BaseState, Battery, BoardState, EStop, GuardState, Verdict
from tests.unit.keyboard.keyboards import Person, person

BOARD = BoardState(
    connected=True,
    boot_id=1,
    drive_state="active",
    latch="none",
    last_refusal="none",
    accepted=1,
    refused=0,
    line_errors=0,
)
BASE = BaseState(armed=True, driving=True, reason="", guard="g", round_trip=0.043, budget_left=0.3, board=BOARD)
FREE = Verdict(allowed=0.6, freedom="free", sensor="", reason="", way_out="")
BLOCKED = Verdict(allowed=0.0, freedom="blocked", sensor="rear", reason="0.21 m", way_out="drive forward")
GUARD = GuardState(
    forward=FREE, backward=BLOCKED, turn_left=FREE, turn_right=FREE, operator="me", reason="", sensors={}
)


def heard(someone: Person, *samples: BaseState | GuardState | EStop | Battery) -> StatusView:
    all_of_it = StatusView()
    for sample in samples:
        all_of_it.take(sample, someone.now)
    return all_of_it


def test_a_robot_that_obeys() -> None:
    someone = person()
    someone.hear("me", 3)
    first, second, third, last = heard(someone, BASE, GUARD, Battery(voltage=24.13)).draw(
        someone.policy, "", someone.now
    )
    assert first == "me drives   armed   0.60 m/s, 1.57 rad/s   round trip 43 ms   battery 24.1 V"
    assert second == "forward free   backward blocked (rear)   left free   right free"
    assert (third, last) == ("the robot obeys", HELP)


def test_each_direction_is_shown_as_what_it_is() -> None:
    verdicts = {way: msgspec.structs.replace(FREE, sensor=way) for way in ("ahead", "behind", "left", "right")}
    guard = msgspec.structs.replace(
        GUARD,
        forward=verdicts["ahead"],
        backward=verdicts["behind"],
        turn_left=verdicts["left"],
        turn_right=verdicts["right"],
    )
    someone = person()
    shown = heard(someone, BASE, guard).draw(someone.policy, "", someone.now)[1]
    assert shown == "forward free (ahead)   backward free (behind)   left free (left)   right free (right)"


def why(someone: Person, *samples: BaseState | GuardState) -> str:
    return heard(someone, *samples).draw(someone.policy, "", someone.now)[2]


def test_the_first_link_that_stops_it_is_named() -> None:
    unarmed = msgspec.structs.replace(BASE, armed=False, reason="let go of all keys")
    blocked = msgspec.structs.replace(GUARD, reason="backward blocked: 0.21 m; drive forward")
    assert "no tick" in why(Person(), unarmed, blocked)
    someone = person()
    someone.hear("joystick", 3, reason="held by joystick")
    assert "held by joystick" in why(someone, unarmed, blocked)
    someone.hear("me", 4, seq=2)
    assert "giraff_guard" in why(someone, unarmed)
    assert "backward blocked: 0.21 m" in why(someone, unarmed, blocked)
    assert "let go of all keys" in why(someone, unarmed, GUARD)
    assert "giraff_base" in why(someone, GUARD)
    someone.press(Key.STOP)
    assert "space bar" in why(someone, BASE, GUARD)


def test_a_stop_is_told_in_clear_words() -> None:
    someone = person()
    engaged = EStop(engaged=True, id=3, by="carer@tablet", reason="child")
    lines = heard(someone, BASE, GUARD, engaged).draw(someone.policy, "STOPPED", someone.now)
    assert "STOPPED" in lines
    assert "EMERGENCY STOP, engaged by carer@tablet: child" in lines
    released = msgspec.structs.replace(engaged, engaged=False)
    assert not any("STOP," in line for line in heard(someone, released).draw(someone.policy, "", someone.now))


def test_what_is_old_is_not_shown_as_if_it_were_now() -> None:
    someone = person()
    someone.hear("me", 3)
    all_of_it = heard(someone, BASE, GUARD, Battery(voltage=24.0))
    someone.wait(STALE + 0.1)
    text = "\n".join(all_of_it.draw(someone.policy, "", someone.now))
    assert "base not heard" in text
    assert "directions: the guard is not heard" in text
    for old in ("armed", "battery", "round trip", "obeys"):
        assert old not in text
