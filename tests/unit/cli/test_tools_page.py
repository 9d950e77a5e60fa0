"""Each command that docs/tools.md names exists, with the options that it shows."""

from __future__ import annotations

import re
import shlex
from typing import Any

import typer.main

from giraff_cli.main import app
from tests.rules.repository import ROOT

PAGE = ROOT / "docs" / "tools.md"


def test_every_command_and_option_of_the_page_exists() -> None:
    root: Any = typer.main.get_command(app)
    found = re.findall(r"`(giraff [^`]+)`|^\$? ?(giraff .+?)(?:  #.*)?$", PAGE.read_text(), re.MULTILINE)
    assert found
    for quoted, line in found:
        said = quoted or line
        words = shlex.split(said.partition(" | ")[0])[1:]
        command = root
        while words and words[0] in getattr(command, "commands", {}):
            command = command.commands[words.pop(0)]
        assert not hasattr(command, "commands"), f"{said!r} is no whole command"
        options = {name for parameter in command.params for name in parameter.opts}
        assert {word for word in words if word.startswith("--")} <= options, said
