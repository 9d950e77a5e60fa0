"""`giraff run --web` and `giraff web` as processes: addresses that open, and nothing left behind."""

import hashlib
import json
import os
import re
import shlex
import signal
import ssl
import subprocess
from collections.abc import Iterator
from contextlib import closing
from http.client import HTTPSConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from giraff_core.network import NetworkConfig
from giraff_node.network.session import close_session, open_session
from tests.support.process_robot import PATIENCE
from tests.support.runs import GIRAFF, PROCESSES, Command, command_in, line_of
from tests.support.waiting import wait

RUN = ("--web", "--hand", "none", "--boards", "host")


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    with command_in(tmp_path) as made:
        yield made


def told(process: subprocess.Popen[str]) -> str:
    """The address for this host's own browser, which comes first."""
    words = line_of(process, "page: ").split()
    assert words[0] == "page:"
    assert re.fullmatch(r"https://127\.0\.0\.1:\d+/#[\w-]{20,}", words[1])
    return words[1]


def got(address: str, path: str, authority: str = "", data: bytes | None = None) -> str:
    """Of the page's port; by a host that trusts `authority`, or trusts anybody."""
    context = ssl.create_default_context(cadata=authority or None)
    if not authority:
        context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    asked = urlsplit(address)
    with closing(HTTPSConnection(str(asked.hostname), asked.port, context=context, timeout=PATIENCE)) as connection:
        connection.request("GET" if data is None else "POST", path, data)
        answer = connection.getresponse()
        assert answer.status < 300, answer.status
        return answer.read().decode()


def kept_of(command: Command) -> tuple[int, str] | None:
    """Port and certificate of the page that a visit has kept for a stop; None: none has."""
    for file in (command.directory / "state").rglob("page-*.json"):
        [page] = json.loads(file.read_bytes())
        return page["port"], page["certificate"]
    return None


def fingerprint(address: str) -> str:
    asked = urlsplit(address)
    pem = ssl.get_server_certificate((str(asked.hostname), asked.port or 0))
    return hashlib.sha256(ssl.PEM_cert_to_DER_cert(pem)).hexdigest()


def host_of(address: str) -> str:
    return address.partition("/#")[0]


def require_a_page_beside(command: Command, target: list[str]) -> None:
    """`giraff web` serves a robot that is there, beside a name that no robot can have."""
    rendezvous = target[target.index("--connect") + 1]
    session = open_session(NetworkConfig(rendezvous=rendezvous, local=True), command.robot, "client")
    odd = session.liveliness().declare_token(f"giraff/{command.robot}/alive/a b/\x1b[2J")
    words = [str(GIRAFF), "web", *target, "--port", "0"]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, env=command.environment, cwd=command.directory, **streams) as web:
        page = host_of(told(web))
        assert "<title>" in got(page, "/", got(page, "/ca.crt"))
        web.send_signal(signal.SIGINT)
        _, err = web.communicate(timeout=PATIENCE)
    del odd
    assert close_session(session)
    assert web.returncode == 0, err


def test_the_page_of_a_run_comes_and_goes_with_it_and_is_named_where_it_dies(
    command: Command,
) -> None:
    with command.start(*RUN) as process:
        page = host_of(told(process))
        trusted = got(page, "/ca.crt")
        assert "<title>" in got(page, "/", trusted)
        line_of(process, "base not armed")
        assert len(command.pids()) == PROCESSES + 1
        assert json.loads(got(page, "/stop", trusted, b""))["asked"]
        line_of(process, "base EMERGENCY STOP")
        wait(lambda: kept_of(command) == (urlsplit(page).port, fingerprint(page)), PATIENCE)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")
    assert command.leaves_nothing()
    with command.start(*RUN) as process:
        target = shlex.split(line_of(process, "giraff drive"))[2:]
        again = host_of(told(process))
        assert "<title>" in got(again, "/", trusted), "a phone that has come to trust it does so again"
        os.kill(command.pid("giraff_node web"), signal.SIGKILL)
        for _ in range(2):  # the first may be from before
            line_of(process, " | ")
        require_a_page_beside(command, target)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert "giraff run: web ended by itself (killed, SIGKILL)" in err, "and the run has gone on"
