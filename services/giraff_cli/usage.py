"""The command line: its help as a terminal shows it, and what was typed wrong in one line, with the way out."""

from __future__ import annotations

import sys
from copy import copy
from typing import Any, Final

import typer.main

from giraff_schemas.text import plain

_LONGEST: Final = 20
"""Characters of the words of an option that stand in its column."""


def obey(app: typer.Typer) -> int:
    """Do what the command line asks for; the exit code."""
    command = with_plain_help(typer.main.get_command(app))
    try:
        return command.main(prog_name="giraff", standalone_mode=False) or 0
    except typer.TyperException as error:
        from giraff_cli.terminal.program import redirected  # noqa: PLC0415  for what is mistyped, which is seldom

        path = _path(command, sys.argv[1:])
        if what := plain(error.format_message()).rstrip("."):  # else it has shown the help
            what = (redirected(what) if "extra argument" in what else "") or what
            print(f"{path}: {what[0].lower()}{what[1:]} (see {path} --help)", file=sys.stderr, flush=True)
        return error.exit_code


def with_plain_help(command: Any) -> Any:
    """The command, whose help and that of all below it has paragraphs of one line, and no types of Python's.

    Typer keeps the line ends of the source and breaks the lines between them once more.
    """
    command.help = "\n\n".join(" ".join(each.split()) for each in (command.help or "").split("\n\n"))
    for parameter in command.params:
        kind = parameter.type = copy(parameter.type)  # one object for all texts
        words = getattr(kind, "choices", ())
        if parameter.param_type_name == "argument":
            kind.get_metavar = lambda *_, **__: ""  # its name says what it is
        elif words:
            words = "|".join(str(getattr(word, "value", word)) for word in words)
            parameter.metavar = words if len(words) <= _LONGEST else parameter.name.upper()
            if len(words) > _LONGEST and words not in parameter.help:
                parameter.help += f" One of {words.replace('|', ', ')}."
    for inner in getattr(command, "commands", {}).values():
        with_plain_help(inner)
    return command


def _path(command: Any, words: list[str]) -> str:
    """The command that they name, as far as there is one."""
    path = "giraff"
    for word in words:
        command = getattr(command, "commands", {}).get(word)
        if command is None:
            break
        path += f" {word}"
    return path
