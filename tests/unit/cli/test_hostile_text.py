"""Text of the network in a terminal and in logs: it steers nothing, whoever has written it."""

import io
import json
import logging
import re
import sys

import pytest
from rich.table import Table

from giraff_client.errors import EmergencyStopError
from giraff_node.network.consent import print_notice
from giraff_node.process.logs import service_logger
from giraff_schemas.messages import EStop
from giraff_schemas.text import printable
from giraff_schemas.trouble import Trouble
from giraff_telemetry.console import CleanConsole
from giraff_tools.terminal.text import json_line, json_page
from tests.unit.cli.typed import Tty

HOSTILE = "\x1b]0;owned\x07\x1b[2J\x9b1m\r\x7f\u202eé"
"""A title, an empty screen, a colour as one character, a line anew, and letters from right to left."""
CLEAN = "?]0;owned??[2J?1m???é"


def test_one_function_cleans_a_line() -> None:
    assert printable(HOSTILE) == CLEAN
    assert printable("a\nb") == "a?b"


def test_a_table_keeps_its_colours_and_nothing_else() -> None:
    out = io.StringIO()
    console = CleanConsole(file=out, force_terminal=True, color_system="standard", width=60)
    table = Table.grid()
    table.add_row(HOSTILE, style="red")
    console.print(table, HOSTILE, sep="\n")
    assert out.getvalue().startswith("\x1b[31m?]0;owned?")
    assert re.sub(r"\x1b\[[0-9;]*m|\n", "", out.getvalue()).isprintable()


@pytest.mark.parametrize("write", [json_line, json_page])
def test_json_has_it_all_and_steers_nothing(write: object) -> None:
    assert callable(write)
    written = write({"by": HOSTILE + "\U000e0001"})
    assert written.replace("\n", "").isprintable()
    assert json.loads(written) == {"by": HOSTILE + "\U000e0001"}


@pytest.mark.parametrize("kind", [io.StringIO, Tty])
def test_a_log_line_is_clean_on_a_terminal_and_in_a_file(
    kind: type[io.StringIO], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stderr", kind())
    log = service_logger("hostile")
    log.error("stopped by %s", HOSTILE, exc_info=ValueError(HOSTILE))
    logging.getLogger("hostile").handlers.clear()
    assert isinstance(sys.stderr, io.StringIO)
    assert sys.stderr.getvalue().count(CLEAN) == 2
    assert sys.stderr.getvalue().replace("\n", "").isprintable()


def test_what_a_command_and_a_script_say_is_clean(capsys: pytest.CaptureFixture[str]) -> None:
    print_notice(HOSTILE)
    assert capsys.readouterr().err == f"giraff: {CLEAN}\n"
    error = EmergencyStopError(EStop(engaged=True, id=1, by=HOSTILE, reason=Trouble(HOSTILE)))
    assert str(error).count(CLEAN) == 2
