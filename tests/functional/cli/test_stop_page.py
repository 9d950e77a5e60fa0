"""`giraff estop engage` by the robot's page, where Zenoh answers nothing.

Each answer: tests/unit/cli/test_stop_page.py.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Never

import msgspec
import pytest

from giraff_cli.estop import engage
from giraff_core.estop.request import BY_WORD
from giraff_schemas.health import WebPage
from giraff_tools.network.command import UnopenedError
from giraff_tools.network.pages import page_file
from giraff_web.server.certificates import made_certificate, own_names
from tests.support.waiting import wait

HOST = "127.0.0.1"
STOPPED = b'{"asked": true, "estop": {"engaged": true, "off": false}}'
ASKED = b'{"asked": true}'


class Page:
    """A page's server; it counts who asks for a stop."""

    def __init__(self, state: Path, answers: list[bytes]) -> None:
        """`answers`: one after another; the last one from then on."""
        self.asked = asked = list[str]()

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                asked.append(self.path)
                body = answers.pop(0) if len(answers) > 1 else answers[0]
                self.send_response(202 if body == ASKED else 200)
                self.send_header("Giraff-Robot", "anne")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *_: object) -> None:  # noqa: A002  as the base class has it
                """Nothing."""

        self.server = ThreadingHTTPServer((HOST, 0), Handler)
        certificate, _ = made_certificate(state, "desk", own_names("desk", [HOST], ()), datetime.now(UTC))
        self.server.socket = certificate.context.wrap_socket(self.server.socket, server_side=True)
        self.address = f"{HOST}:{self.server.server_port}"
        self.place = WebPage(
            port=self.server.server_port, hosts=("host.invalid", HOST), certificate=certificate.fingerprint
        )


@contextmanager
def page(state: Path, *answers: bytes) -> Iterator[Page]:
    made = Page(state, list(answers))
    serving = threading.Thread(target=made.server.serve_forever, args=(0.02,))
    serving.start()
    yield made
    made.server.shutdown()
    serving.join()
    made.server.server_close()


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("STATE_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("GIRAFF_CONFIG", "/dev/null")
    return tmp_path


def keep(*places: WebPage) -> None:
    page_file("anne").write_bytes(msgspec.json.encode(places))


def unopened(*_: object, **__: object) -> Never:
    raise UnopenedError("no Zenoh session")


def test_a_page_that_is_known_confirms_while_zenoh_still_shakes_hands(
    state: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shaking = threading.Event()

    monkeypatch.setattr(engage, "visit", lambda *_, **__: shaking.wait(60.0))
    with page(state, ASKED, ASKED, STOPPED) as served:
        keep(served.place)
        assert engage.engage_by_plan("anne", (), "", 60.0) == 0
        assert not shaking.is_set()
        shaking.set()
    assert served.asked == ["/stop"] * 3, "asked again until base's word was there"
    assert capsys.readouterr() == (f"anne: STOPPED, {BY_WORD}, told by its page at {served.address}\n", "")


def test_a_page_that_is_known_confirms_where_zenoh_cannot_be_opened_but_not_at_another_address(
    state: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(engage, "visit", unopened)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    with page(state, STOPPED, STOPPED) as served:
        keep(served.place)
        assert engage.engage_by_plan("anne", (), "", 60.0) == 0
        assert capsys.readouterr() == (f"anne: STOPPED, told by its page at {served.address}\n", "")
        assert engage.engage_by_plan("anne", (), "", 60.0, off=True) == 1
        assert capsys.readouterr().out.startswith(
            "anne: STOPPED, not off: this robot's drive has no other off, told by"
        )
        assert engage.engage_by_plan("anne", ("192.0.2.9",), "", 0.5) == 2
    assert "NOT CONFIRMED: it is not at the address of --connect" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("robot", "file", "told"),
    [
        ("anne", "", "its certificate is another than the one that was kept"),
        ("bob", "", "its certificate is not known here: see it once with `giraff watch --robot bob`"),
        (None, "", "its certificate is not known here: see it once with `giraff watch --robot NAME`"),
        ("anne", "[", "whether it is yours is not known: "),
    ],
)
def test_any_other_page_is_asked_and_confirms_nothing(
    state: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    robot: str | None,
    file: str,
    told: str,
) -> None:
    monkeypatch.setattr(engage, "visit", unopened)
    if file:
        (state / "robot.toml").write_text(file)
        monkeypatch.setenv("GIRAFF_CONFIG", str(state / "robot.toml"))
    with page(state, STOPPED) as served:
        certificate = served.place.certificate if file else "another"
        keep(msgspec.structs.replace(served.place, certificate=certificate))
        code = engage.engage_by_plan(robot, (), "", 0.5, served.address)
        wait(lambda: served.asked, 60.0)
    out, err = capsys.readouterr()
    assert (code, out) == (2, "")
    assert "NOTHING IS STOPPED: use the battery switch; no Zenoh session" in err
    assert f"at {served.address}, NOT CONFIRMED: " in err
    assert told in err


def test_a_stop_that_zenoh_confirms_is_one_whatever_the_page_says(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(engage, "visit", lambda *_, **__: 0)
    assert engage.engage_by_plan("anne", (), "", 0.5) == 0
    assert engage.engage_by_plan("anne", (), "", 0.5, "nonsense") == 0
    assert "--page is left out: 'nonsense' is no address of a page" in capsys.readouterr().err
