"""The word of `giraff completion`. What it does is imported when it is asked for."""

from __future__ import annotations

from typing import Annotated, Literal

import typer


def completion(shell: Annotated[Literal["bash", "zsh", "fish"], typer.Argument(metavar="SHELL")]) -> None:
    """Print the script by which bash, zsh or fish completes `giraff` at the TAB key. See docs/tools.md.

    It completes verbs, options and files, and from the network robots, topics, services and parameters.
    """
    from giraff_cli.completion.scripts import SCRIPTS  # noqa: PLC0415

    typer.echo(SCRIPTS[shell], nl=False)
