"""What was typed wrong, told as everything else is: in one line, with the way out."""

from __future__ import annotations

import sys
from typing import Any

import typer.main

from giraff_schemas.text import plain


def obey(app: typer.Typer) -> int:
    """Do what the command line asks for; the exit code."""
    command = typer.main.get_command(app)
    try:
        return command.main(prog_name="giraff", standalone_mode=False) or 0
    except typer.TyperException as error:
        path = _path(command, sys.argv[1:])
        if what := plain(error.format_message()).rstrip("."):  # else it has shown the help
            print(f"{path}: {what[0].lower()}{what[1:]} (see {path} --help)", file=sys.stderr, flush=True)
        return error.exit_code


def _path(command: Any, words: list[str]) -> str:
    """The command that they name, as far as there is one."""
    path = "giraff"
    for word in words:
        command = getattr(command, "commands", {}).get(word)
        if command is None:
            break
        path += f" {word}"
    return path
