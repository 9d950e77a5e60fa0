"""What no page can do to the real server: floods, crowds, silence and nonsense."""

import asyncio
import contextlib
import gc
import json
import select
import socket
import ssl
from pathlib import Path
from typing import Any

import aiohttp
import msgspec
import pytest

from giraff_schemas.messages import EStop
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.limits import Allowance, Limits
from giraff_web.messages import LARGEST, Looking, Refused
from giraff_web.pages import Closed, Opened, StopAsked
from giraff_web.server.connection import Connection
from giraff_web.server.connection_limiter import ConnectionLimiter, Guarded
from giraff_web.server.server import PortError, Server
from tests.support.web_pages import HOST, IPHONE, STOP, Desk, browser, closed, desk, page, sign_in, told, trying, wish

BAD_MESSAGES = {
    "nonsense": b"nonsense",
    "unknown": b'{"type": "fly"}',
    "further field": b'{"type": "stop", "now": true}',
    "no number": b'{"type": "wish", "n": 1, "tick": null, "hold": 0, "input": "pad", "forward": 1e999}',
    "too fast": b'{"type": "wish", "n": 1, "tick": null, "hold": 0, "input": "pad", "forward": 1.1}',
    "deep": b"[" * 8000,
    "oversized": b'{"type": "stop", "x": "' + b"x" * LARGEST + b'"}',
    "huge": b"x" * 1_000_000,
    "never sent": b'{"type": "seen", "n": 7}',
    "no text": b"\xff\xfe",
    "empty": b"",
}


@pytest.mark.parametrize("what", BAD_MESSAGES)
def test_a_page_that_says_what_no_page_does_is_closed_with_the_reason(tmp_path: Path, what: str) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as socket:
            await socket.send_frame(BAD_MESSAGES[what], aiohttp.WSMsgType.TEXT)
            code, reason = await closed(socket)
            assert code == 4400
            assert reason
            await it.until(lambda: not it.server._connections)

    trying(tmp_path, course)


def test_so_is_one_that_says_it_in_binary(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as socket:
            await socket.send_bytes(STOP.encode())
            assert await closed(socket) == (4400, "a message is JSON text, and no binary data")

    trying(tmp_path, course)


def test_a_flood_ends_the_page_and_loses_no_stop(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async def flood(socket: aiohttp.ClientWebSocketResponse) -> None:
            with contextlib.suppress(ConnectionError):  # in the end it is closed
                await socket.send_str(wish(0))
                await socket.send_str(STOP)
                for n in range(1, 100):
                    await socket.send_str(wish(n))

        async with browser(it) as session:
            await sign_in(it, session)
            async with page(it, session) as socket:
                flooding = asyncio.create_task(flood(socket))
                assert await closed(socket) == (4400, "more than 5 messages a second")
                await flooding
            assert len(it.server._box) <= 32 + 3  # nothing was taken meanwhile
            await it.until(lambda: it.of(StopAsked))

    trying(tmp_path, course, limits=Limits()._replace(rate=5.0))


def test_so_many_pages_and_no_more_and_those_that_drive_beside_them(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, browser(it) as driver, contextlib.AsyncExitStack() as open_pages:
            for _ in range(2):
                await open_pages.enter_async_context(page(it, session))
            await it.until(lambda: len(it.of(Opened)) == 2)
            async with page(it, session) as third:
                code, reason = await closed(third)
                assert (code, reason[:19]) == (4429, "2 pages are open he")
            await sign_in(it, driver)
            for _ in range(3):
                await open_pages.enter_async_context(page(it, driver))
            await it.until(lambda: len(it.of(Opened)) == 5)
            async with page(it, driver) as fourth:
                assert (await closed(fourth))[0] == 4429
            async with session.post(f"{it.url}/stop") as answer:
                assert answer.status == 202

    trying(tmp_path, course, most_watchers=2, limits=Limits()._replace(drivers=3))


def test_strangers_may_not_watch_where_the_network_is_secured_but_stop(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            async with page(it, session) as socket:
                code, reason = await closed(socket)
                assert (code, "open the address" in reason) == (4403, True)
            async with session.post(f"{it.url}/stop") as answer:
                assert (answer.status, await answer.json()) == (202, {"asked": True})
            await sign_in(it, session)
            async with page(it, session):
                await it.until(lambda: it.of(Opened))
        assert [type(event) for event in it.events[:2]] == [StopAsked, Opened]

    trying(tmp_path, course, strangers_watch=False)


def test_a_page_gets_three_states_then_the_newest_once_it_has_shown_them_and_then_a_picture(
    tmp_path: Path,
) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as slow, page(it, session) as quick:
            await it.until(lambda: len(it.of(Opened)) == 2)
            assert [(await told(each))["type"] for each in (slow, quick)] == ["hello", "hello"]
            for n in range(1, 21):
                it.show()
                assert (await told(quick))["n"] == n
                await quick.send_str(json.dumps({"type": "seen", "n": n}))
            assert [(await told(slow))["n"] for _ in range(3)] == [1, 2, 3]
            it.server.send_picture(it.of(Opened)[0].page, b"picture")
            await slow.send_str('{"type": "seen", "n": 1}')
            assert (await told(slow))["n"] == 20
            it.show(5)
            await slow.send_str('{"type": "seen", "n": 20}')
            assert (await told(slow))["n"] == 25
            assert await asyncio.wait_for(slow.receive_bytes(), 20.0) == b"picture"

    trying(tmp_path, course)


def test_a_page_gets_no_picture_that_waits_for_it_once_it_looks_no_longer(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as socket:
            await it.until(lambda: it.of(Opened))
            number = it.of(Opened)[0].page
            assert (await told(socket))["type"] == "hello"
            for n in range(1, 4):
                it.show()
                assert (await told(socket))["n"] == n
            it.server.send_picture(number, b"picture")
            it.server.send(number, Looking(on=False, why=NO_TROUBLE))
            assert (await told(socket))["type"] == "looking"
            await socket.send_str('{"type": "seen", "n": 3}')
            for n in (4, 5):
                it.show()
                assert (await told(socket))["n"] == n

    trying(tmp_path, course)


def test_a_page_that_shows_nothing_is_closed_and_its_hand_gone(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as socket:
            await it.until(lambda: it.of(Opened))
            it.show()
            code, reason = await closed(socket)
            assert (code, reason) == (4408, "the page showed nothing for 0.1 s")
            await it.until(lambda: it.of(Closed))

    trying(tmp_path, course, limits=Limits()._replace(silent=0.1))


def test_a_session_that_ended_ends_its_page(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            await sign_in(it, session)
            async with page(it, session) as socket:
                await it.until(lambda: it.of(Opened))
                it.server._sessions._sessions.clear()
                code, reason = await closed(socket)
                assert (code, reason[:20]) == (4403, "this session is over")
                await it.until(lambda: it.of(Closed))

    trying(tmp_path, course)


@pytest.mark.parametrize("sent", [b"", b"GET", b"\x16\x03\x01\x02\x00\x01"], ids=["bare", "plain", "begun"])
@pytest.mark.parametrize("addresses", [1, 100])
def test_stop_gets_through_a_crowd_that_costs_little(tmp_path: Path, sent: bytes, addresses: int) -> None:
    crowded, other = "127.0.0.2", "127.0.0.3"
    crowd_of = [crowded, *(f"127.0.1.{n}" for n in range(1, addresses))]

    async def course(it: Desk) -> None:
        limiter = await limiter_of(it)
        limits = Limits()
        begun = sent[:1] == b"\x16"
        kept = limits.handshakes if begun else limits.bare
        most = min(kept.most, addresses * kept.of_one_address)
        async with browser(it, address=crowded) as watcher, page(it, watcher) as socket:
            await it.until(lambda: it.of(Opened))
            with contextlib.ExitStack() as crowd:
                for n in range(500):
                    caller = crowd.enter_context(socket_from(crowd_of[n % addresses]))
                    caller.connect((HOST, it.server.port))
                    with contextlib.suppress(ConnectionError):  # an idle one is sent away
                        caller.sendall(sent)
                await it.until(lambda: len(limiter.handshakes if begun else limiter.bare) == most)
                for address in (crowded, other):
                    async with browser(it, address=address) as session, session.post(f"{it.url}/stop") as answer:
                        assert answer.status == 202
                await socket.send_str(STOP)
                await it.until(lambda: len(it.of(StopAsked)) == 3)
                assert [stop.device for stop in it.of(StopAsked)] == [
                    f"iPhone at {address}" for address in (crowded, other, crowded)
                ]
                assert len(limiter.connections) <= 3
                assert len(limiter.bare) <= limits.bare.most
                assert tls_of_servers() <= limits.handshakes.most + 4

    gc.collect()
    gc.disable()  # what has ended must go without it
    try:
        trying(tmp_path, course, limits=Limits()._replace(stops=Limits().stops._replace(patience=0.01)))
    finally:
        gc.enable()


def tls_of_servers() -> int:
    """Return how many TLS objects of servers this process has."""
    return sum(each.server_side for each in gc.get_objects() if type(each) is ssl.SSLObject)


def test_pages_of_one_address_leave_room_for_others_to_watch(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with (
            browser(it) as many, browser(it, address="127.0.0.2") as other, contextlib.AsyncExitStack() as open_pages,
        ):  # fmt: skip
            for _ in range(2):
                await open_pages.enter_async_context(page(it, many))
            async with page(it, many) as third:
                assert await closed(third) == (
                    4429,
                    "2 pages of this address watch, and that is the most; close one of them",
                )
            await open_pages.enter_async_context(page(it, other))
            await sign_in(it, many)
            await open_pages.enter_async_context(page(it, many))
            await it.until(lambda: len(it.of(Opened)) == 4)

    trying(tmp_path, course, limits=Limits()._replace(watchers_of_one_address=2))


def test_pings_are_answered_and_count_as_what_a_page_says(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, session.ws_connect(f"{it.url}/ws", autoping=False) as socket:
            for n in range(6):
                await socket.ping(b"%d" % n)
            answers = [await socket.receive() for _ in range(6)]
            assert [each.data for each in answers[:5]] == [b"%d" % n for n in range(5)]
            assert answers[5].data == 4400

    trying(tmp_path, course, limits=Limits()._replace(rate=5.0))


WORD = EStop(
    engaged=True, id=7, by="web@desk (iPhone)", reason=Trouble("STOP on a page"), engaged_ns=1 << 60, instance="base"
)


def test_a_request_to_stop_is_answered_with_bases_word(tmp_path: Path) -> None:
    async def stop(it: Desk, session: aiohttp.ClientSession) -> tuple[int, dict[str, Any]]:
        async with session.post(f"{it.url}/stop") as answer:
            return answer.status, await answer.json()

    async def course(it: Desk) -> None:
        async with browser(it) as session:
            asking = [asyncio.create_task(stop(it, session)) for _ in range(5)]
            while len(it.server._box) < 5:
                await asyncio.sleep(0.005)
            it.turn()
            it.server.confirm(msgspec.structs.replace(WORD, id=6))  # in the turn that has the stops: it may be older
            it.turn()
            it.server.confirm(WORD)
            answers = sorted(await asyncio.gather(*asking), key=lambda each: each[0])
        assert answers[4] == (202, {"asked": True}), "four of one address may wait"
        for status, answer in answers[:4]:
            assert (status, answer["asked"]) == (200, True)
            assert msgspec.convert(answer["estop"], EStop) == WORD

    trying(tmp_path, course, limits=Limits()._replace(stops=Limits().stops._replace(patience=20.0)))


async def limiter_of(it: Desk) -> ConnectionLimiter:
    await it.until(lambda: it.server._connection_limiter is not None)
    assert it.server._connection_limiter is not None
    return it.server._connection_limiter


def socket_from(address: str) -> socket.socket:
    found = socket.socket()
    found.bind((address, 0))
    return found


SHORT = Allowance(most=10, of_one_address=10, patience=0.2)


def test_an_idle_connection_ends(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            async with session.post(f"{it.url}/stop") as answer:  # kept alive by the browser
                assert answer.status == 202
            with socket_from(HOST) as silent:
                silent.connect((HOST, it.server.port))
                limiter = await limiter_of(it)
                await it.until(lambda: len(limiter) == 0)
                assert silent.recv(1) == b""

    trying(tmp_path, course, limits=Limits()._replace(bare=SHORT, connections=SHORT))


def test_what_came_and_went_leaves_nothing(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session:
            for _ in range(30):
                async with page(it, session) as socket:
                    await socket.send_str(STOP)
            limiter = await limiter_of(it)
            it.show(1000)
            assert len(it.server._box) <= 90  # nobody has taken anything yet
            await it.until(lambda: len(it.of(Closed)) == len(it.of(Opened)))
            await it.until(lambda: not it.server._connections)
        await it.until(lambda: len(limiter) == 0)
        gc.collect()
        left = [type(each) for each in gc.get_objects() if isinstance(each, Connection | Guarded)]
        assert len(left) < 10, left

    trying(tmp_path, course)


def test_its_descriptor_is_readable_when_there_are_events(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        descriptor = it.server.descriptor()
        assert descriptor is not None
        assert select.select([descriptor], [], [], 0.0)[0] == []
        async with browser(it) as session, session.post(f"{it.url}/stop") as answer:
            assert answer.status == 202
        assert select.select([descriptor], [], [], 20.0)[0] == [descriptor]
        assert list(it.server.poll()) == [StopAsked(IPHONE)]
        assert select.select([descriptor], [], [], 0.0)[0] == []

    trying(tmp_path, course)


def test_it_ends_with_pages_open_and_tells_them(tmp_path: Path) -> None:
    async def course(it: Desk) -> None:
        async with browser(it) as session, page(it, session) as socket, page(it, session):
            await it.until(lambda: len(it.of(Opened)) == 2)
            ending = asyncio.create_task(asyncio.to_thread(it.server.close))
            assert await closed(socket) == (1001, "the service ends")
            await ending  # though the second one never answered
            assert not it.server._thread.is_alive()
            it.server.send(1, Refused(why=NO_TROUBLE))  # to nobody
            it.show()

    trying(tmp_path, course)


def test_a_port_in_use_is_told_in_one_line(tmp_path: Path) -> None:
    with desk(tmp_path) as it:
        port = it.server.port
        with pytest.raises(PortError, match=f"^port {port} is in use: end what"), desk(tmp_path, port=port):
            pass


def test_an_address_of_another_host_is_told(tmp_path: Path) -> None:
    with pytest.raises(PortError, match=r"is none of this host; leave it empty"), desk(tmp_path, address="192.0.2.1"):
        pass


def test_one_that_was_not_started_leaves_nothing_open(tmp_path: Path) -> None:
    with desk(tmp_path) as it:
        server = it.server
        other = Server(server._config, server._site, print, print, print)
        other.close()
        assert other._loop.is_closed()
