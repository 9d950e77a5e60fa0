"""The real server on loopback: who may watch, drive and stop, and what each is told."""

import asyncio
import contextlib
import ssl
from pathlib import Path

import aiohttp
import pytest

from giraff_web.limits import Limits
from giraff_web.messages import LetGo, PageWish, Reset, RouteCancel
from giraff_web.pages import Closed, Opened, Said, StopAsked
from giraff_web.server.host import Ask, ask, sockets
from tests.support.web_pages import HOST, IPHONE, STOP, Desk, browser, closed, page, sign_in, told, trying, wish


def test_who_has_no_token_watches_and_may_stop_and_nothing_else(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as socket:
            it.show()
            await it.until(lambda: it.of(Opened))
            first = await told(socket)
            assert (first["type"], first["device"], first["may_drive"]) == ("hello", IPHONE, False)
            reset = '{"type": "reset", "id": "1", "engaged_ns": "2", "tick": null}'
            look = '{"type": "look", "on": true}'
            let_go = '{"type": "let_go", "n": 2, "why": "finger"}'
            go = '{"type": "go", "n": 1, "tick": ["1", "1"], "goal": "kitchen"}'
            for text in (wish(1), reset, let_go, look, go, '{"type": "route_cancel"}', STOP):
                await socket.send_str(text)
            await it.until(lambda: it.of(StopAsked))
            assert it.events == [Opened(1, IPHONE, may_drive=False), Said(1, RouteCancel()), StopAsked(IPHONE)]
        await it.until(lambda: it.of(Closed))

    trying(tmp_path, course)


def test_a_token_opens_a_session_once_and_another_is_announced(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        await it.until(lambda: it.announced)
        token = it.server.token
        assert it.announced == [[f"{it.url}/#{token}"]]
        async with browser(it) as session:
            assert await sign_in(it, session) == (200, {"device": IPHONE})
            (cookie,) = session.cookie_jar
            assert cookie.key == "__Host-giraff"
            assert (cookie["path"], cookie["samesite"]) == ("/", "Strict")
            assert cookie["secure"]
            assert cookie["httponly"]
            await it.until(lambda: len(it.announced) == 2)
            assert it.announced[1] == [f"{it.url}/#{it.server.token}"] != it.announced[0]
            async with page(it, session) as socket:
                await it.until(lambda: it.of(Opened))
                assert (await told(socket))["may_drive"]
                await socket.send_str(wish(1))
                await socket.send_str('{"type": "reset", "id": "1", "engaged_ns": "2", "tick": null}')
                await socket.send_str('{"type": "let_go", "n": 2, "why": "finger"}')
                await it.until(lambda: len(it.of(Said)) == 3)
                assert [type(said.message) for said in it.of(Said)] == [PageWish, Reset, LetGo]
        async with browser(it, agent="X11; Linux Firefox/132.0") as other:
            status, answer = await sign_in(it, other, token)
            assert status == 403
            assert answer["why"].startswith("this address was used ")
            assert IPHONE in answer["why"]
        assert it.log[0] == f"{IPHONE} may drive; the next device opens another address"

    trying(tmp_path, course)


def test_guessing_is_slowed(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            answers = [await sign_in(it, session, "wrong") for _ in range(7)]
            assert [status for status, _ in answers] == [403] * 5 + [429] * 2
            async with session.post(f"{it.url}/session", json={"token": it.server.token}) as answer:
                assert 0 < int(answer.headers["Retry-After"]) <= 60
        async with browser(it, address="127.0.0.2") as other:
            assert (await sign_in(it, other))[0] == 200
        assert any("not a token of this service" in line for line in it.log)

    trying(tmp_path, course)


def test_what_is_no_session_request_is_told(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            for body in (b"", b"nonsense", b'{"token": 5}', b"[" * 8000, b"x" * 1_000_000, b"\xff"):
                async with session.post(f"{it.url}/session", data=body) as answer:
                    assert answer.status == 400
                    assert (await answer.json())["why"].startswith("the body is to be")

    trying(tmp_path, course)


def test_another_page_is_refused_and_under_another_name_only_a_stop_is_taken(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        port = it.server.port
        other_page: tuple[dict[str, str], ...] = (
            {"Origin": "https://evil.example"},
            {"Origin": "null"},
            {"Origin": f"http://{HOST}:{port}"},
            {"Origin": f"https://{HOST}:{port + 1}"},
            {"Host": "vm.fritz.box", "Origin": "https://evil.example"},
        )
        other_name: tuple[dict[str, str], ...] = (
            {"Host": "evil.example"},
            {"Host": f"evil.example:{port}", "Origin": f"https://evil.example:{port}"},
            {"Host": "[::"},
        )
        good: tuple[dict[str, str], ...] = (
            {"Origin": it.url},
            {"Host": f"desk.local:{port}", "Origin": f"https://desk.local:{port}"},
            {"Host": "DESK"},
        )
        async with browser(it) as session:
            for headers in (*other_page, *other_name):
                stop = "/stop" if headers in other_page else "/stop/"
                asked = ("GET", "/"), ("GET", "/stop"), ("GET", "/ca.crt"), ("POST", stop), ("POST", "/session")
                for method, path in (*asked, ("GET", "/ws")):
                    async with session.request(method, it.url + path, headers=headers) as answer:
                        assert answer.status == 403, (method, path, headers)
                with pytest.raises(aiohttp.WSServerHandshakeError):
                    await session.ws_connect(f"{it.url}/ws", headers=headers)
            for headers in good:
                async with session.post(f"{it.url}/stop?off", headers=headers) as answer:
                    assert answer.status == 202
            for headers in other_name:
                async with session.post(f"{it.url}/stop", headers=headers) as answer:
                    assert (answer.status, await answer.json()) == (202, {"asked": True})
                    told_names = [name for name in answer.headers if "Cookie" in name or "Access-Control" in name]
                    assert told_names == []
                    assert "evil" not in str(answer.headers)
                async with session.post(f"{it.url}/stop?off", headers=headers) as answer:
                    assert answer.status == 403, "whoever wants off asks again at the address"
                    assert (await answer.json())["why"].startswith("the stop is asked for, and off is not: ")
        await it.until(lambda: len(it.of(StopAsked)) == len(good) + 2 * len(other_name))
        assert [stop.off for stop in it.of(StopAsked)] == [True] * len(good) + [False] * 2 * len(other_name)
        assert it.of(Opened) == []

    trying(tmp_path, course, limits=Limits()._replace(stops=Limits().stops._replace(patience=0.01)))


def test_each_answer_keeps_the_page_to_itself(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            for method, path, status in (
                ("GET", "/ca.crt", 200),
                ("GET", "/page/../main.py", 404),
                ("GET", "/page/%2e%2e/main.py", 404),
                ("GET", "/nothing", 404),
                ("GET", "/stop", 405),
                ("GET", "/ws", 426),
                ("POST", "/stop", 202),
            ):
                async with session.request(method, it.url + path) as answer:
                    assert answer.status == status, path
                    assert answer.headers["X-Content-Type-Options"] == "nosniff"
                    assert answer.headers["Cache-Control"] == "no-store"
                    assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
                    assert "accelerometer=(self)" in answer.headers["Permissions-Policy"]

    trying(tmp_path, course)


def test_who_has_the_certificate_trusts_it_and_nobody_else(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with aiohttp.ClientSession() as stranger:
            with pytest.raises(aiohttp.ClientConnectorCertificateError):
                await stranger.get(it.url)
            async with stranger.get(f"{it.url}/ca.crt", ssl=False) as answer:
                assert answer.content_type == "application/x-x509-ca-cert"
                authority = await answer.read()
        async with browser(it, trusting=authority) as session, session.post(f"{it.url}/stop") as answer:
            assert answer.status == 202

    trying(tmp_path, course)


@pytest.mark.parametrize(
    ("method", "path", "headers", "status"),
    [
        ("POST", "/session", {"Content-Encoding": "gzip"}, 415),
        ("GET", "/ws", {"Upgrade": "websocket", "Connection": "keep-alive"}, 400),
        ("GET", "/ws", {"Upgrade": "websocket", "Connection": "upgrade", "Sec-WebSocket-Key": "abc"}, 400),
    ],
)
def test_what_the_library_refuses_gets_a_clear_word_and_no_line_in_the_log(
    tmp_path: Path, method: str, path: str, headers: dict[str, str], status: int, caplog: pytest.LogCaptureFixture
) -> None:
    async def course(it: Desk) -> None:
        async with (
            browser(it) as session,
            session.request(
                method, it.url + path, headers=headers, data=b"abc", skip_auto_headers=["Content-Type"]
            ) as got,
        ):
            assert got.status == status
            assert "open the address that the page service shows" in (await got.json())["why"]
            assert got.headers["Server"] == "giraff"
        assert it.log == []

    trying(tmp_path, course)
    assert caplog.records == []


PLAIN = "HTTP/1.1 400 Bad Request"


@pytest.mark.parametrize(
    ("sent", "answer"),
    [
        ([b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"], PLAIN),
        ([b"POST /stop HTTP/1.1\r\nContent-Length: 9\r\n\r\n", b"x" * 9], PLAIN),
        ([b"G"], PLAIN),
        ([b"GET / HTTP/1.1\r\nX: ", *[b"x" * 4000] * 3], PLAIN),
        ([b"SSH-2.0-x\r\n"], ""),
        ([b"\x00GET / HTTP/1.1\r\n\r\n"], ""),
    ],
    ids=["get", "post", "torn", "large", "ssh", "binary"],
)
def test_plain_http_is_told_the_address_in_one_line(tmp_path: Path, sent: list[bytes], answer: str) -> None:
    async def course(it: Desk) -> None:
        reader, writer = await asyncio.open_connection(HOST, it.server.port)
        with contextlib.suppress(ConnectionError):  # what speaks neither is cut
            for part in sent:
                writer.write(part)
                await writer.drain()
        heard = b""
        with contextlib.suppress(ConnectionError):
            heard = await asyncio.wait_for(reader.read(), 20.0)
        head, _, body = heard.decode().partition("\r\n\r\n")
        assert head.partition("\r\n")[0] == answer
        assert body == (f"This page speaks https: open {it.url}/\n" if answer else "")
        assert "evil" not in head
        limiter = it.server._connection_limiter
        assert limiter is not None
        await it.until(lambda: len(limiter) == 0)  # though the caller keeps it open
        writer.close()
        assert (it.events, it.log) == ([], [])

    bare = Limits().bare._replace(patience=0.2)
    trying(tmp_path, course, limits=Limits()._replace(bare=bare))


def test_plain_http_that_goes_on_for_ever_is_cut(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        _, writer = await asyncio.open_connection(HOST, it.server.port)

        async def flood() -> None:
            while True:
                writer.write(b"G" * 65536)
                await writer.drain()

        with pytest.raises(ConnectionError):
            await flood()
        writer.close()

    trying(tmp_path, course, limits=Limits()._replace(bare=Limits().bare._replace(patience=600.0)))


def test_a_request_that_is_none_leaves_no_line_in_the_log(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    async def course(it: Desk) -> None:
        context = ssl.create_default_context(cadata=it.authority.decode())
        reader, writer = await asyncio.open_connection(HOST, it.server.port, ssl=context)
        writer.write(b"GET / HTTP/1.1\r\nContent-Length: -1\r\nHost: 127.0.0.1\r\n\r\n")
        assert b"400" in await reader.readline()
        writer.close()
        with contextlib.suppress(ConnectionError, ssl.SSLError):  # the service has closed it first
            await writer.wait_closed()
        assert it.log == []

    trying(tmp_path, course)
    assert caplog.records == []


async def named(socket: aiohttp.ClientWebSocketResponse, *pages: int) -> None:
    """Wait until this page is told that these are open."""
    while True:
        message = await told(socket)
        if message["type"] == "pages" and [each["page"] for each in message["pages"]] == [*pages]:
            return


ENDED = (4410, "this page was ended; reload it to watch, or open the address that the page service shows now to drive")


def test_a_page_that_may_drive_ends_others_and_one_that_watches_is_told_nothing(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, browser(it, agent="X11; Linux Firefox/132.0") as other:
            await sign_in(it, session)
            async with page(it, session) as driver, page(it, other) as watcher:
                await it.until(lambda: len(it.of(Opened)) == 2)
                await named(driver, 1, 2)
                await watcher.send_str('{"type": "end", "page": 1}')
                await driver.send_str('{"type": "end", "page": 7}')
                await driver.send_str('{"type": "end", "page": 2}')
                await it.until(lambda: it.of(Closed))
                assert await closed(watcher) == ENDED
                await named(driver, 1)
                assert it.of(Closed) == [Closed(2)]
                assert it.log[1:] == [f"Firefox on Linux at {HOST} was ended by {IPHONE}"]

    trying(tmp_path, course)


def test_its_own_host_lists_the_pages_and_ends_one_with_its_session(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        (path,) = sockets({"RUNTIME_DIRECTORY": str(tmp_path)}, tmp_path)
        assert path.stat().st_mode & 0o777 == 0o600
        reader, writer = await asyncio.open_unix_connection(path)
        writer.write(b"nonsense\n")
        assert await reader.read() == b""
        writer.close()
        async with browser(it) as session:
            await sign_in(it, session)
            async with page(it, session) as one, page(it, session) as two:
                it.show()
                await it.until(lambda: len(it.of(Opened)) == 2)
                answer = await asyncio.to_thread(ask, path, Ask())
                assert (answer.robot, answer.port, answer.ended) == ("one", it.server.port, False)
                assert [(each.page, each.device, each.may_drive) for each in answer.pages] == [
                    (1, IPHONE, True),
                    (2, IPHONE, True),
                ]
                answer = await asyncio.to_thread(ask, path, Ask(end=1))
                assert (answer.ended, answer.pages) == (True, ())
                for socket in (one, two):
                    assert await closed(socket) == ENDED
            async with page(it, session) as again:
                await it.until(lambda: len(it.of(Opened)) == 3)
                assert not (await told(again))["may_drive"]
            assert (await sign_in(it, session))[0] == 200, "the address that is shown now"

    trying(tmp_path, course)
