"""`giraff web --devices` and `--end`: what a person is told of the pages that are open here."""

import json
import socket
from pathlib import Path

import pytest

from giraff_cli.web import devices
from giraff_web.messages import OpenPage
from giraff_web.server.host import Answer, Ask, run_directory, sockets
from tests.unit.cli.typed import Giraff


class Service:
    """One page service, and what it was asked."""

    def __init__(self, port: int, driver: int, *devices: str) -> None:
        self.pages = tuple(
            OpenPage(page=number, device=device, may_drive=number < 3, age=61.0 * number)
            for number, device in enumerate(devices, 1)
        )
        self.port, self.driver = port, driver
        self.ended: list[int] = []

    def answer(self, asked: Ask) -> Answer:
        if asked.end:
            self.ended.append(asked.end)
        return Answer(
            robot="sim-desk", port=self.port, driver=self.driver, pages=self.pages, ended=asked.end in (0, 1, 2, 3)
        )


@pytest.fixture
def giraff(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, tmp_path: Path) -> Giraff:
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "none"))  # where another test may have a service
    return giraff


@pytest.fixture
def services(monkeypatch: pytest.MonkeyPatch) -> dict[Path, Service | Exception]:
    """By their sockets; put more there."""
    made: dict[Path, Service | Exception] = {}

    def ask(path: Path, asked: Ask) -> Answer:
        service = made[path]
        if isinstance(service, Exception):
            raise service
        return service.answer(asked)

    monkeypatch.setattr(devices, "sockets", lambda: list(made))
    monkeypatch.setattr(devices, "ask", ask)
    return made


def test_the_open_pages_are_listed(giraff: Giraff, services: dict[Path, Service | Exception]) -> None:
    services[Path("one")] = Service(8443, 1, "iPhone at 10.0.0.7", "Firefox on Linux at 10.0.0.8", "Edge at 10.0.0.9")
    services[Path("two")] = Service(40123, 0)
    code, out, err = giraff("web", "--devices")
    assert (code, err) == (0, "")
    first, *rows, last = [line.split("  ") for line in out.splitlines()]
    assert (first, last) == (["sim-desk, port 8443"], ["sim-desk, port 40123: no page is open"])
    assert [[cell.strip() for cell in row if cell] for row in rows[1:]] == [
        ["1", "iPhone", "10.0.0.7", "1 min 01 s", "drives"],
        ["2", "Firefox on Linux", "10.0.0.8", "2 min 02 s", "may drive"],
        ["3", "Edge", "10.0.0.9", "3 min 03 s", "watches"],
    ]
    told = json.loads(giraff("web", "--devices", "--json")[1])
    assert [(each["port"], [page["drives"] for page in each["pages"]]) for each in told] == [
        (8443, [True, False, False]),
        (40123, []),
    ]


@pytest.mark.parametrize("name", ["2", "8443/2", "firefox on linux", "10.0.0.8", "Firefox on Linux at 10.0.0.8"])
def test_one_is_ended_by_what_it_is_called(
    giraff: Giraff, services: dict[Path, Service | Exception], name: str
) -> None:
    service = services[Path("one")] = Service(8443, 1, "iPhone at 10.0.0.7", "Firefox on Linux at 10.0.0.8")
    assert giraff("web", "--end", name) == (0, "8443/2 (Firefox on Linux at 10.0.0.8) is ended\n", "")
    assert service.ended == [2]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("iPhone", "2 pages are called 'iPhone': 8443/1 (iPhone at 10.0.0.7); 8443/2 (iPhone at 10.0.0.7); end one by"),
        ("1", "2 pages are called '1': 8443/1 (iPhone at 10.0.0.7); 40123/1 (Edge at ::1); end one by its number"),
        ("an\x1b[31m", "no open page is called 'an?[31m'; there are: 8443/1 (iPhone at 10.0.0.7); 8443/2 (iPhone"),
        ("", "no open page is called ''; there are: 8443/1"),
    ],
)
def test_a_name_of_none_or_of_several_ends_nothing(
    giraff: Giraff, services: dict[Path, Service | Exception], name: str, told: str
) -> None:
    both = [Service(8443, 1, "iPhone at 10.0.0.7", "iPhone at 10.0.0.7"), Service(40123, 0, "Edge at ::1")]
    services |= {Path("one"): both[0], Path("two"): both[1]}
    code, out, err = giraff("web", "--end", name)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"giraff: {told}")
    assert [service.ended for service in both] == [[], []]


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (PermissionError(), "page.sock: not permitted; ask as root, or as the user that the page service runs as"),
        (TimeoutError(), "page.sock: no answer for 2 s: the page service hangs; start it again"),
        (OSError(5, "Input/output error"), "page.sock: Input/output error; start the page service again"),
        (ValueError(), "page.sock: no page service of this version answers there; start it again"),
        (FileNotFoundError(), devices._NOBODY),
    ],
)
@pytest.mark.parametrize("words", [("--devices",), ("--end", "1")])
def test_a_service_that_gives_no_answer_is_told_in_a_line(
    giraff: Giraff, services: dict[Path, Service | Exception], fault: Exception, told: str, words: tuple[str, ...]
) -> None:
    services[Path("page.sock")] = fault
    assert giraff("web", *words) == (2, "", f"giraff: {told}\n")


@pytest.mark.parametrize("words", [("--devices",), ("--end", "1")])
def test_the_socket_of_a_dead_service_is_none(giraff: Giraff, tmp_path: Path, words: tuple[str, ...]) -> None:
    left = socket.socket(socket.AF_UNIX)
    left.bind(str(tmp_path / "page-1.sock"))
    left.close()
    assert giraff("web", *words) == (2, "", f"giraff: {devices._NOBODY}\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("more", [("--port", "1"), ("--robot", "x"), ("--connect", "x"), ("--end", "1")])
def test_nothing_else_goes_with_it(giraff: Giraff, more: tuple[str, ...]) -> None:
    code, out, err = giraff("web", "--devices", *more)
    assert (code, out) == (2, "")
    assert "stand alone" in err


def test_the_run_directory_is_this_users() -> None:
    home = {"HOME": "/home/ann"}
    assert run_directory(home) == Path("/home/ann/.local/state/giraff")
    assert run_directory(home | {"XDG_RUNTIME_DIR": "/run/user/7"}) == Path("/run/user/7/giraff")
    assert run_directory(home | {"RUNTIME_DIRECTORY": "/run/giraff/web:/run/x"}) == Path("/run/giraff/web")


def test_a_service_is_found_without_its_environment(tmp_path: Path) -> None:
    """By ssh or sudo."""
    home = {"HOME": str(tmp_path / "ann")}
    made = [
        folder / "page-1.sock"
        for folder in (run_directory(home), tmp_path / "user" / "7" / "giraff", tmp_path / "giraff" / "web")
    ]
    for path in made:
        path.parent.mkdir(parents=True)
        path.touch()
    assert list(sockets(home | {"XDG_RUNTIME_DIR": str(tmp_path / "other")}, tmp_path)) == made
