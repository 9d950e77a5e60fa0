"""Who may drive: one-time tokens, sessions, and how guessing is slowed."""

from itertools import count

import pytest

from giraff_web.sessions import MOST_SESSIONS, SESSION_LIFE, WRONG, Denied, Granted, Sessions

PHONE, LAPTOP = "Android phone at 10.0.0.7", "Firefox on Linux at 10.0.0.8"


@pytest.fixture
def it() -> Sessions:
    numbers = count()
    return Sessions(lambda: f"secret-{next(numbers)}")


def granted(of: Sessions, device: str = PHONE, now: float = 0.0) -> str:
    """The cookie of a session by the open token."""
    got = of.redeem(of.token, device, "10.0.0.7", now)
    assert isinstance(got, Granted)
    return got.cookie


def denied(of: Sessions, token: str, address: str = "10.0.0.8", now: float = 0.0) -> Denied:
    got = of.redeem(token, LAPTOP, address, now)
    assert isinstance(got, Denied)
    return got


def test_a_token_begins_a_session_and_another_is_open(it: Sessions) -> None:
    first = it.token
    cookie = granted(it)
    assert it.token not in (first, cookie)
    assert it.device(cookie, 1.0) == PHONE
    assert it.device("another", 1.0) == ""
    assert it.device("", 1.0) == ""


@pytest.mark.parametrize(
    ("after", "told"), [(0.0, "0 s ago"), (59.9, "59 s ago"), (180.0, "3 min ago"), (7300, "2 h ago")]
)
def test_a_used_token_is_refused_by_the_name_of_its_user_and_when(it: Sessions, after: float, told: str) -> None:
    """Its user is refused as well: another device may have the same name and address."""
    token = it.token
    granted(it)
    for device, address in ((LAPTOP, "10.0.0.8"), (PHONE, "10.0.0.7")):
        got = it.redeem(token, device, address, after)
        assert isinstance(got, Denied)
        assert got.why == f"this address was used {told} by {PHONE}; open the one that the page service shows now"


def test_a_cookie_is_no_token_and_a_token_no_cookie(it: Sessions) -> None:
    token = it.token
    assert it.device(token, 0.0) == ""
    cookie = granted(it)
    assert denied(it, cookie).why == WRONG
    assert it.device(token, 0.0) == ""


@pytest.mark.parametrize("token", ["", "x", "secret-00", "\ud800", "x" * 100_000, "secret-0\n"])
def test_a_wrong_one_is_told_the_way_out(it: Sessions, token: str) -> None:
    assert denied(it, token) == Denied(WRONG, tell=True)


def test_after_five_wrong_ones_within_a_minute_even_the_right_one_waits(it: Sessions) -> None:
    for second in range(5):
        assert denied(it, "wrong", now=float(second)).why == WRONG
    got = denied(it, it.token, now=10.5)
    assert got.wait == 49.5
    assert got.why == "too many wrong tokens from 10.0.0.8; wait 50 s and open the address anew"
    assert isinstance(it.redeem(it.token, LAPTOP, "10.0.0.9", 10.5), Granted)
    assert isinstance(it.redeem(it.token, LAPTOP, "10.0.0.8", 60.0), Granted)


def test_the_window_slides(it: Sessions) -> None:
    for second in (0.0, 50.0, 51.0, 52.0, 53.0, 60.5):
        assert denied(it, "wrong", now=second).why == WRONG
    assert denied(it, "wrong", now=61.0).wait == 49.0


def test_a_used_token_is_no_guess(it: Sessions) -> None:
    token = it.token
    granted(it)
    assert {denied(it, token).wait for _ in range(20)} == {0.0}


def test_a_flood_is_logged_once_a_second_for_each_address(it: Sessions) -> None:
    moments = [each * 0.1 for each in range(31)]
    assert sum(denied(it, "wrong", now=moment).tell for moment in moments) == 4
    assert denied(it, "wrong", address="10.0.0.9", now=3.0).tell


def test_guesses_of_many_addresses_take_no_more_room(it: Sessions) -> None:
    for number in range(5000):
        denied(it, "wrong", address=f"10.1.{number // 256}.{number % 256}")
    guesses = it._guesses
    assert len(guesses._wrong) == len(guesses._told) == 1024


def test_used_tokens_and_sessions_take_no_more_room(it: Sessions) -> None:
    first = it.token
    cookies = [granted(it, now=float(number)) for number in range(200)]
    assert len(it._used) == 64
    assert denied(it, first, now=200.0).why == WRONG
    assert sum(bool(it.device(cookie, 200.0)) for cookie in cookies) == MOST_SESSIONS


def test_the_session_that_was_unused_longest_ends(it: Sessions) -> None:
    cookies = [granted(it) for _ in range(MOST_SESSIONS)]
    assert it.device(cookies[0], 1.0) == PHONE
    granted(it)
    assert (it.device(cookies[0], 1.0), it.device(cookies[1], 1.0)) == (PHONE, "")


def test_a_session_ends_after_twelve_hours(it: Sessions) -> None:
    cookie = granted(it, now=5.0)
    assert SESSION_LIFE == 12 * 3600.0
    assert it.device(cookie, 4.9 + SESSION_LIFE) == PHONE
    assert it.device(cookie, 5.0 + SESSION_LIFE) == ""


def test_neither_cookie_nor_used_token_is_kept(it: Sessions) -> None:
    token = it.token
    cookie = granted(it)
    kept = repr((it._sessions, it._used))
    assert token not in kept
    assert cookie not in kept


def test_an_ended_session_drives_no_more_and_no_other_ends_with_it(it: Sessions) -> None:
    cookie, other = granted(it), granted(it, LAPTOP)
    it.end(cookie)
    it.end("")
    assert (it.device(cookie, 1.0), it.device(other, 1.0)) == ("", LAPTOP)
