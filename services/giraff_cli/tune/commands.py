"""The verbs of `giraff tune`. What they do is imported when it is asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import require_extra

tune = typer.Typer(no_args_is_help=True, help="Compute gains of a robot: see docs/balancer.md.")


@tune.callback()
def verbs() -> None:
    """Compute gains of a robot: see docs/balancer.md."""


@tune.command()
def balance(
    file: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="A robot file; else GIRAFF_CONFIG's.", show_default=False),
    ] = None,
) -> None:
    """Compute k1 to k4 of a robot that balances from the masses and lengths of its robot file, and draw a step of 5 cm.

    It asks no robot and changes none. Exit code: 0; 2 the file is none of a robot that balances, or is not sound.
    """
    require_extra("tune balance", "numpy", "analysis,cli")
    from giraff_cli.tune.balance import tune_balance  # noqa: PLC0415

    raise typer.Exit(tune_balance(file))
