"""What pages are told of who drives and why the robot does not, in simulated time."""

from giraff_schemas.trouble import NO_TROUBLE
from giraff_web.messages import State
from tests.loop.browsers import Browser, room


def shown(browser: Browser) -> State:
    assert browser.state is not None
    return browser.state


def test_before_anybody_holds_nothing_is_wrong() -> None:
    with room() as it:
        watcher = it.browsers.add("laptop", may_drive=False)
        it.run(1.0)
        assert (shown(watcher).why, shown(watcher).operator, shown(watcher).armed) == (NO_TROUBLE, "", False)


def test_all_pages_are_told_who_drives() -> None:
    with room() as it:
        phone, watcher = it.browsers.add("phone"), it.browsers.add("laptop", may_drive=False)
        it.drive(phone)
        it.run(0.2)
        state = shown(watcher)
        assert (state.operator, state.device, state.page, state.why) == ("web", "phone", phone.number, NO_TROUBLE)
        assert state.speed is not None
        assert state.speed[0] > 0.2
        assert it.log[-1] == "phone drives"


def test_who_puts_the_phone_away_is_no_broken_link() -> None:
    with room() as it:
        phone, watcher = it.browsers.add("phone"), it.browsers.add("laptop", may_drive=False)
        it.drive(phone)
        phone.let_go()
        it.run(0.5)
        phone.hung = True
        it.run(0.9)
        assert "the page of phone is out of sight" in shown(watcher).why.what
        it.run(4.0)
        assert (shown(watcher).why, shown(watcher).operator) == (NO_TROUBLE, "")


def test_a_hand_that_was_lost_is_told_with_whose_it_was() -> None:
    with room() as it:
        phone, watcher = it.browsers.add("phone"), it.browsers.add("laptop", may_drive=False)
        it.drive(phone)
        phone.let_go("hidden")
        phone.hung = True  # it says nothing more
        it.run(0.2)
        assert shown(watcher).why.what == "phone: the page was hidden"


def test_keys_that_are_let_go_arm_the_robot_and_keep_the_lease_while_the_page_is_seen() -> None:
    with room() as it:
        laptop = it.browsers.add("laptop")
        laptop.input = "keys"
        it.run(0.3)
        laptop.touch()
        it.run(0.05)
        it.go(laptop)  # a key that is down asks for motion, and arms nothing
        it.run(0.5)
        assert (it.driver, it.armed) == ("web", False)
        laptop.let_go()
        it.run(0.4)
        assert it.armed
        it.run(2.6)
        assert (it.driver, it.armed, shown(laptop).why) == ("web", True, NO_TROUBLE)
        laptop.touch()
        it.run(0.05)
        it.go(laptop)
        it.run(0.5)
        assert it.driven_ms(it.now - 0.1) > 90
