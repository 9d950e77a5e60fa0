"""Where a page is to be opened: for people a code, for programs a line each."""

import io
import os
import sys
from pathlib import Path

import pytest
from rich.console import Console
from rich.screen import Screen

from giraff_tools.terminal import addresses
from giraff_tools.terminal.addresses import Code, CodeScreen
from tests.unit.cli.typed import Tty

ONCE = "hMmDbpDbMPVvSFEbH7bN3w"
FAR = f"https://192.168.1.7:8443/#{ONCE}"
HERE = f"https://127.0.0.1:8443/#{ONCE}"
BLOCKS = " ▀▄█"


def terminal(monkeypatch: pytest.MonkeyPatch, columns: int = 80) -> Tty:
    """Standard output from here on."""
    made = Tty()
    monkeypatch.setattr(sys, "stdout", made)
    for name, value in {"TERM": "xterm", "COLUMNS": str(columns), "NO_COLOR": "1"}.items():
        monkeypatch.setenv(name, value)
    return made


def code_rows(shown: str) -> list[str]:
    return [line for line in shown.splitlines() if line.strip() and set(line) <= set(BLOCKS)]


def test_a_program_is_told_a_line_each_this_hosts_first(capsys: pytest.CaptureFixture[str]) -> None:
    addresses.print_addresses([FAR, HERE])
    assert capsys.readouterr().out == f"page: {HERE}\npage: {FAR}\n"


def test_a_person_is_told_all_and_shown_the_code_of_the_one_that_a_phone_can_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    output = terminal(monkeypatch)
    addresses.print_addresses([HERE, FAR])
    shown = output.getvalue()
    assert [line.strip() for line in shown.splitlines() if ONCE in line] == [HERE, FAR]
    assert [row.rstrip() for row in code_rows(shown)] == [row.rstrip() for row in Code(FAR).rows() if row.strip()]
    assert "To watch and to STOP no token is needed: https://192.168.1.7:8443/\n" in shown
    assert "first device that opens it" in shown


@pytest.mark.parametrize("columns", [30, 32])
def test_a_terminal_that_is_too_narrow_for_a_code_gets_the_address_in_one_piece(
    columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = terminal(monkeypatch, columns)
    addresses.print_addresses([FAR])
    assert code_rows(output.getvalue()) == []
    assert f"    {FAR}\n" in output.getvalue()


@pytest.mark.parametrize("given", [[FAR], [HERE, FAR]])
def test_a_port_at_every_address_is_at_the_loopback_too(given: list[str]) -> None:
    assert addresses.with_loopback(given) == (HERE, FAR)
    assert addresses.with_loopback([]) == ()


def test_what_no_other_host_can_open_has_no_code(monkeypatch: pytest.MonkeyPatch) -> None:
    output = terminal(monkeypatch)
    addresses.print_addresses([HERE])
    assert code_rows(output.getvalue()) == []
    assert "no other host can open it" in output.getvalue()


def test_a_code_is_light_on_dark_whatever_the_terminals_colours_are() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, color_system="truecolor", width=80)
    with console.capture() as capture:
        console.print(Code(FAR))
    lit = [line for line in capture.get().splitlines() if line]
    assert lit
    assert all(line.startswith("\x1b[38;2;255;255;255;48;2;0;0;0m") for line in lit)


def test_the_margin_of_a_code_is_light() -> None:
    rows = Code(FAR).rows()
    assert {len(row) for row in rows} == {len(rows[0])}
    assert set(rows[0]) == {"█"}
    assert {row[:2] + row[-2:] for row in rows[:-1]} == {"████"}


@pytest.mark.parametrize(
    ("address", "is_far"),
    [
        (FAR, True),
        (HERE, False),
        ("https://localhost:8443/#x", False),
        ("https://[::1]:8443/#x", False),
        ("https://[fd00::7]:8443/#x", True),
        ("https://pc.local:8443/#x", True),
    ],
)
def test_the_loopback_is_of_no_use_to_a_phone(address: str, is_far: bool) -> None:
    assert addresses.of_others([address]) == (address if is_far else "")


LONGEST = f"https://[2001:db8:1234:5678:9abc:def0:1234:5678]:65535/#{ONCE}xx"


def screen_of(shown: CodeScreen, width: int = 80, height: int = 24) -> list[str]:
    """As `giraff run` shows it: what does not fit is cut off."""
    console = Console(file=io.StringIO(), width=width, height=height, color_system=None)
    with console.capture() as capture:
        console.print(Screen(shown))
    return [row.rstrip() for row in capture.get().splitlines()]


@pytest.mark.parametrize(("address", "code"), [(FAR, 33), (LONGEST, 41)])
def test_a_code_and_its_address_fill_80_by_24_at_most(address: str, code: int) -> None:
    rows = screen_of(CodeScreen([HERE, address], ""))
    assert len(Code(address).rows()[0]) == code
    assert rows[: len(Code(address).rows())] == Code(address).rows()
    told = "".join(rows[len(Code(address).rows()) :])
    assert told == f"{address}Scan it with a phone in the same network. Any key goes back."


@pytest.mark.parametrize(("width", "height"), [(32, 24), (80, 19)])
def test_a_terminal_too_small_for_a_code_is_told_what_it_needs(width: int, height: int) -> None:
    told = "".join(screen_of(CodeScreen([FAR], ""), width, height)).replace(" ", "")
    assert "█" not in told
    assert "33columnsand20rows" in told
    assert FAR in told


def test_a_code_that_no_phone_could_use_is_not_shown() -> None:
    rows = screen_of(CodeScreen([HERE], "this computer is in no network. Connect it."))
    assert rows[0].startswith("There is no code: no other host can open the page")
    assert HERE in rows
    assert code_rows("\n".join(rows)) == []


def test_whoever_has_read_enough_ends_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as gone:
        monkeypatch.setattr(sys, "stdout", gone)
        addresses.print_addresses([FAR])
        addresses.print_addresses([FAR])


def test_no_other_verb_waits_for_the_library() -> None:
    source = Path(addresses.__file__).read_text(encoding="utf-8")
    assert "\nimport segno" not in source
