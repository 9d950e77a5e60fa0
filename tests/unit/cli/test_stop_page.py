"""What of a page's answer proves a stop, and how a visit keeps where the page is.

With a page that answers over TLS: tests/functional/cli/test_stop_page.py.
"""

from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import msgspec
import pytest

from giraff_cli.estop import page
from giraff_cli.estop.page import Answer, PageStop, Place, doubt_of, place_of
from giraff_schemas.codec import encode
from giraff_schemas.health import Health, WebPage
from giraff_schemas.topics import health_key
from giraff_tools.network import pages
from giraff_tools.network.pages import PageKeeper, kept_pages, page_file
from tests.support.one_process import Clock, Session

STOPPED = b'{"asked": true, "estop": {"engaged": true, "off": false}}'
ASKED = b'{"asked": true}'
GOOD = Answer("f1", "anne", 200, STOPPED)
PAGE = WebPage(port=8443, hosts=("10.0.0.5", "anne.lan"), certificate="f1")


@pytest.mark.parametrize(
    ("answer", "known", "doubt"),
    [
        (GOOD, {"f0", "f1"}, ""),
        (GOOD, set(), "its certificate is not known here: see it once with `giraff watch --robot anne`"),
        (GOOD, {"f0"}, "its certificate is another than the one that was kept"),
        (GOOD._replace(certificate=""), {"f1"}, "its certificate is another than the one that was kept"),
        (GOOD._replace(robot="bob"), {"f1"}, "it serves bob"),
        (GOOD._replace(robot=""), {"f1"}, "it serves a robot that it does not name"),
        (GOOD._replace(status=202, body=ASKED), {"f1"}, "base has not told it that it has stopped"),
        (GOOD._replace(body=STOPPED.replace(b"true, ", b"false, ")), {"f1"}, "base has not told it"),
        (GOOD._replace(body=STOPPED.replace(b'"engaged": true', b'"engaged": 1')), {"f1"}, "base has not told it"),
        (GOOD._replace(body=b"\xff" + b"[" * 60_000), {"f1"}, "base has not told it that it has stopped"),
        (GOOD._replace(status=403, body=b'{"why": "not so"}'), {"f1"}, "it refuses with HTTP status 403: not so"),
        (GOOD._replace(status=500), {"f1"}, "it refuses with HTTP status 500: no reason given"),
    ],
)
def test_only_a_known_page_of_this_robot_with_the_word_of_base_proves_a_stop(
    answer: Answer, known: set[str], doubt: str
) -> None:
    assert doubt_of(answer, "anne", known).startswith(doubt)
    assert bool(doubt_of(answer, "anne", known)) == bool(doubt)


@pytest.mark.parametrize(
    ("asking", "confirmed"),
    [
        ((), "10.0.0.5:8443"),
        (((None, ""),), "10.0.0.5:8443"),
        (((None, "2 bases are called anne"),), ""),
        (((object(), ""),), ""),
        (((None, ""), (None, "")), ""),
    ],
)
def test_what_base_says_over_zenoh_counts_more_than_a_page(
    asking: tuple[tuple[object, str], ...], confirmed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "kept_pages", lambda _: (PAGE,))
    offs: list[bool] = []

    def ask(_: Place, *, off: bool) -> Answer:
        offs.append(off)
        return GOOD

    monkeypatch.setattr(page, "ask", ask)
    stop = PageStop("anne", Place("10.0.0.5", 8443), 60.0, off=True)
    for refusal, unconfirmed in asking:
        stop.watch("anne", cast(Any, SimpleNamespace(refusal=refusal, unconfirmed=unconfirmed)))
    stop.watch("bob", cast(Any, SimpleNamespace(refusal=object(), unconfirmed="")))
    assert stop.stopped() == ({"anne"} if confirmed else set())
    assert (stop.confirmed, stop.unconfirmed) == (confirmed, "")
    assert (offs, stop.is_off) == ([True], False), "this page tells of no off"


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("10.0.0.5:8443", "10.0.0.5:8443"),
        ("https://Anne.lan:8443/#token", "anne.lan:8443"),
        ("[fe80::1]:8443", "[fe80::1]:8443"),
        ("anne.lan", ""),
        (":8443", ""),
        ("anne:none", ""),
        ("anne:70000", ""),
    ],
)
def test_the_address_of_a_page_is_read_as_a_person_has_it(text: str, place: str) -> None:
    if place:
        assert str(place_of(text)) == place
    else:
        with pytest.raises(ValueError, match=r"address|[Pp]ort"):
            place_of(text)


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path


def answered(health: bytes, _: bytes) -> tuple[float, bytes]:
    return 0.01, health


def visit(*told: WebPage | None) -> None:
    """A visit of a robot that has these pages; None: a service that does not listen yet."""
    clock = Clock()
    session = Session(clock)
    for number, told_page in enumerate(told):
        health = Health(
            service="web", instance=str(number), host="h", pid=1, uptime=1.0, ok=True, faults=(), page=told_page
        )
        session.answer(health_key("anne", "web"), partial(answered, encode(health)))
    keeper = PageKeeper()
    keeper.ask(cast(Any, session), "anne")
    clock.sleep(1.0)
    keeper.wait(60.0)


def test_a_visit_keeps_the_pages_that_it_hears_in_the_place_of_those_before(state: Path) -> None:
    assert kept_pages("anne") == ()
    visit(PAGE)
    assert kept_pages("anne") == (PAGE,)
    visit()
    assert kept_pages("anne") == (PAGE,), "one that hears none changes nothing"
    other = msgspec.structs.replace(PAGE, certificate="f2", hosts=("h",) * 100)
    visit(other)
    assert kept_pages("anne") == (msgspec.structs.replace(other, hosts=("h",) * 8),)
    visit(*(msgspec.structs.replace(PAGE, port=port) for port in range(50)))
    assert len(kept_pages("anne")) == 4, "anybody may tell one on an open network"
    assert kept_pages("bob") == ()
    assert [file.name for file in state.rglob("*") if file.is_file()] == ["page-anne.json"]


@pytest.mark.usefixtures("state")
def test_a_page_that_does_not_listen_yet_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    again: list[str] = []
    monkeypatch.setattr(PageKeeper, "_ask_later", lambda _, __, robot: again.append(robot))
    visit(None)
    assert (again, kept_pages("anne")) == (["anne"], ())


@pytest.mark.usefixtures("state")
def test_a_state_folder_that_cannot_be_used_fails_no_visit(monkeypatch: pytest.MonkeyPatch) -> None:
    file = page_file("anne")
    file.parent.mkdir(parents=True)
    for damaged in (b"", b"\xff", b"{}", b'[{"port": "x"}]', b"[" * 60_000):
        file.write_bytes(damaged)
        assert kept_pages("anne") == ()
    visit(PAGE)
    assert kept_pages("anne") == (PAGE,), "a damaged file is replaced"
    file.unlink()
    file.mkdir()
    visit(PAGE)
    assert kept_pages("anne") == ()
    monkeypatch.setenv("STATE_DIRECTORY", "/dev/null/nowhere")
    visit(PAGE)
    assert kept_pages("anne") == ()
    assert pages.page_file("anne") == Path("/dev/null/nowhere/page-anne.json")
