"""What Zenoh logs, and what of it is an attempt."""

from collections.abc import Callable

import pytest

from giraff_core.live import Live
from giraff_sentry.config import SentryConfig
from giraff_sentry.policy import Refusal, Refusals, told

ZID = "aae767b47ff2bb13173f1e3fd2877583"
MODULE = "zenoh::net::routing::interceptor::access_control"
ACTIONS = (
    "Query",
    "Reply",
    "Put",
    "Delete",
    "Declare/Undeclare Subscriber",
    "Declare/Undeclare Queryable",
    "Declare/Undeclare Liveliness Token",
    "Liveliness Query",
    "Declare Liveliness Subscriber",
)


def decided(action: str, key: str = "giraff/r/cmd_vel", allowed: bool = False, thread: int = 1) -> str:
    """As Zenoh logs a decision, with its colours."""
    word = "authorized" if allowed else "unauthorized"
    return (
        f"\x1b[2m2026-11-21T11:07Z\x1b[0m \x1b[35mTRACE\x1b[0m ThreadId({thread:02d}) \x1b[2m{MODULE}\x1b[0m: "
        f"{ZID} on Interface(lo)+CertCommonName(desk)+Transport(Tls)+{ZID} is {word} to {action} (ingress) on {key}"
    )


def cached(action: str, key: str = "giraff/r/cmd_vel") -> str:
    return (
        f"2026-11-21T11:07Z TRACE  rx-0 ThreadId(12) {MODULE}: Using cached result: "
        f"{ZID} is unauthorized to {action} (ingress) on {key}"
    )


def looked_up(key: str, thread: int = 1) -> list[str]:
    return [decided(action, key, thread=thread) for action in ACTIONS]


def counted(*lines: str) -> dict[Refusal, int]:
    refusals = Refusals(Live(SentryConfig()))
    for line in lines:
        refusals.on_line(line)
    list(refusals.news(-100.0))  # a query is known for an attempt when nothing has followed it for a while
    return dict(refusals.news(0.0))


@pytest.mark.parametrize("action", ["Put", "Delete"])
@pytest.mark.parametrize("line", [decided, cached])
def test_an_attempt_is_counted(line: Callable[[str], str], action: str) -> None:
    refusals = Refusals(Live(SentryConfig()))
    for _ in range(3):
        refusals.on_line(line(action))
    assert dict(refusals.news(0.0)) == {(ZID, action.lower(), "giraff/r/cmd_vel"): 3}


def test_what_zenoh_only_looks_up_is_no_attempt() -> None:
    assert counted(*looked_up("giraff/r/odom"), *looked_up("giraff/r/lease")) == {}


def test_an_attempt_after_a_look_up_of_the_same_key_counts() -> None:
    assert counted(*looked_up("giraff/r/odom"), decided("Put", "giraff/r/odom")) == {(ZID, "put", "giraff/r/odom"): 1}


def test_threads_are_told_apart() -> None:
    """Two threads log into each other's look-ups."""
    one, two = looked_up("giraff/r/odom", thread=1), looked_up("giraff/r/odom", thread=2)
    mixed = [line for pair in zip(one, two, strict=True) for line in pair]
    assert counted(*mixed) == {}


def test_a_query_is_an_attempt_unless_a_reply_is_looked_up_with_it() -> None:
    key = "giraff/r/estop/reset"
    assert counted(*looked_up(key)) == {}
    assert counted(decided("Query", key), decided("Query", key), *looked_up("giraff/r/odom")) == {
        (ZID, "query", key): 2
    }
    refusals = Refusals(Live(SentryConfig()))
    refusals.on_line(decided("Query", key))
    assert list(refusals.news(0.0)) == []
    assert list(refusals.news(0.5)) == [((ZID, "query", key), 1)]


@pytest.mark.parametrize("action", ACTIONS)
def test_what_is_allowed_is_nothing(action: str) -> None:
    assert counted(decided(action, allowed=True)) == {}


@pytest.mark.parametrize(
    "line", ["", "something else", "\x1b[0m", "is unauthorized to Put (ingress) on", "WARN zenoh::net something else"]
)
def test_other_lines_are_nothing(line: str) -> None:
    assert counted(line) == {}


def test_a_failed_greeting_is_told_without_zenohs_advice() -> None:
    line = "2026-11-21T11:07Z  WARN ThreadId(06) zenoh_link_tls::unicast: received fatal alert: UnknownCA. Hint: x."
    [(refusal, count)] = counted(line).items()
    assert told(refusal, count, "") == "refused a caller that is not of this network: received fatal alert: UnknownCA"


def test_what_goes_on_is_told_now_and_then_with_its_count() -> None:
    refusals = Refusals(Live(SentryConfig()))
    said: list[tuple[int, int]] = []
    for second in range(30):
        for _ in range(5):
            refusals.on_line(cached("Put"))
        said += [(second, count) for _, count in refusals.news(float(second))]
    assert said == [(0, 5), (10, 50), (20, 50)]


def test_a_flood_of_keys_is_bounded_and_told() -> None:
    refusals = Refusals(Live(SentryConfig()))
    for number in range(1000):
        refusals.on_line(decided("Put", f"giraff/r/{number}"))
    news = dict(refusals.news(0.0))
    assert len(news) == 51
    assert news["", "more", ""] == 950
    assert "950 times" in told(("", "more", ""), 950, "")
    assert list(refusals.news(20.0)) == []
    refusals.on_line(cached("Put"))
    assert list(refusals.news(21.0)) == [((ZID, "put", "giraff/r/cmd_vel"), 1)], "the flood is forgotten"


def test_the_certificate_is_named_with_the_way_out() -> None:
    refusal = (ZID, "put", "giraff/r/cmd_vel")
    assert told(refusal, 30, "desk") == "refused desk, 30 times: put on giraff/r/cmd_vel; [network.access] says who may"
    assert ZID in told(refusal, 1, "")
