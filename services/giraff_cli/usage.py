"""The command line: its help as a terminal shows it, and what was typed wrong in one line, with the way out."""

import re
import shlex
import sys
from collections.abc import Iterable
from copy import copy
from itertools import takewhile
from typing import Any, Final

import typer.main

from giraff_schemas.text import meant, plain

_LONGEST: Final = 20
"""Characters of the words of an option that stand in its column."""

_EXAMPLES: Final = """\
move 1.0 --speed 0.2
turn 180deg
arc 1.0 90deg
go kitchen
camera view --save head.jpg
camera board board.svg
localize --at 1.5,2.2,0deg
logs --since 10min --level warning
topic echo odom --field x --count 5
topic info odom
topic hz odom --for 10
topic pub battery '{"voltage": 23.5}' --robot sim-mine
node info guard
param get guard.margin
param describe guard.margin
param set guard.margin 0.3
param save guard.margin
frames --from range_rear_link --to base_link
odom set 1,2,90deg
record -o drive.mcap --for 60
play drive.mcap --loop
replay drive.mcap
vision --from drive.mcap
check wheels
calibrate odometry
tune balance --file deploy/robots/balancer.toml
encoder disk disk.svg
map show deploy/worlds/flat.toml
map convert deploy/worlds/flat.toml flat.yaml
map make ground-floor
place add kitchen 3.2,1.5,90deg
place remove kitchen
place forbid 5,0 5,1.2
keys host robot 192.168.1.20
completion bash
""".splitlines()
"""The example in the help of a command, and of a group the first one. Other commands need no word."""


def run_app(app: typer.Typer) -> int:
    """Do what the command line asks for; the exit code."""
    command: Any = typer.main.get_command(app)
    try:
        return command.main(prog_name="giraff", standalone_mode=False) or 0
    except typer.TyperException as error:
        path, command, rest = _path(command, sys.argv[1:])
        if not rest and hasattr(command, "commands"):  # its message is the help
            print(error.format_message(), flush=True)
        else:
            print(f"{path}: {_told(error, path, command, rest)} (see {path} --help)", file=sys.stderr, flush=True)
        return error.exit_code


def complete(app: typer.Typer) -> int:
    """Answer a shell that asks what the last word can become; the exit code."""
    from giraff_cli.completion.answer import print_candidates  # noqa: PLC0415

    print_candidates(typer.main.get_command(app), sys.argv[1:])
    return 0


def with_plain_help(command: Any, path: str) -> Any:
    """Return the command `path`, whose help and that of all below it has plain paragraphs and an example.

    Plain: of one line, and without types of Python's. Typer keeps the line ends of the source and breaks the lines
    between them once more. It would also draw frames by a library that takes longer to import than all else.
    """
    command.help = "\n\n".join(" ".join(each.split()) for each in (command.help or "").split("\n\n"))
    command.short_help = first_sentence(command.help)
    command.rich_markup_mode = None
    command.epilog = f"Example: giraff {next((each for each in _EXAMPLES if f'{each} '.startswith(f'{path} ')), path)}"
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
    for name, inner in getattr(command, "commands", {}).items():
        with_plain_help(inner, f"{path} {name}")
    return command


def first_sentence(text: str) -> str:
    """Return how a help begins, in one line."""
    line = " ".join(text.partition("\n\n")[0].split())
    return line if line.endswith("?") else line.partition(". ")[0].rstrip(".") + "."


def _told(error: typer.TyperException, path: str, command: Any, rest: list[str]) -> str:
    """Return what is wrong, with the word that was meant."""
    if rest and not rest[0].startswith("-") and hasattr(command, "commands"):
        return f"no command {rest[0]!r}{_meant(rest[0], (*command.commands, '--help', '--version'))}"
    there = [*(name for parameter in command.params for name in parameter.opts), "--help", "-h"]
    # A command that takes negative numbers takes a mistyped option for a value, and misses or refuses another one.
    option = next((word.partition("=")[0] for word in rest if word.startswith("--")), "--")
    if hasattr(error, "possibilities"):
        option = str(getattr(error, "option_name", option))
    if option not in {*there, "--"}:
        return f"no option {option}{_meant(option, there)}"
    what = plain(error.format_message()).rstrip(".")
    if path == "giraff param set" and ("extra argument" in what or "issing argument" in what):
        what = _setting(rest) or what
    if "extra argument" in what:
        from giraff_tools.terminal.program import redirected  # noqa: PLC0415  for what is mistyped, which is seldom

        what = redirected(what) or what
        if any("-o" in parameter.opts for parameter in command.params):
            what += f": the file is written as -o {what.rpartition('(')[2].removesuffix(')')}"
    return what[:1].lower() + what[1:]


def _setting(rest: list[str]) -> str:
    """Return how `param set` is written, where service, field and value are joined in another way; empty: no idea."""
    words = " ".join(takewhile(lambda word: not word.startswith("--"), rest))
    if found := re.fullmatch(r"(\w+)[. ]([\w.]+) ?[= ] ?(\S+)", words):
        return f"write `giraff param set {found[1]}.{found[2]} {shlex.quote(found[3])}`"
    return "write it like `giraff param set guard.margin 0.3`" if "=" in words else ""


def _meant(word: str, there: Iterable[str]) -> str:
    return f": {hint}" if (hint := meant(word, there).strip()) else ""


def _path(command: Any, words: list[str]) -> tuple[str, Any, list[str]]:
    """The command that they name, as far as there is one; it, and the words after it."""
    path = "giraff"
    for number, word in enumerate(words):
        inner = getattr(command, "commands", {}).get(word)
        if inner is None and (assumed := getattr(command, "assumed", "")):
            return f"{path} {assumed}", command.commands[assumed], words[number:]
        if inner is None:
            return path, command, words[number:]
        command = inner
        path += f" {word}"
    return path, command, []
