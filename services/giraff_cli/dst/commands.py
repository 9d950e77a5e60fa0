"""The options of `giraff dst`. What it does is imported when it is asked for."""

import os
from typing import Annotated

import typer

from giraff_cli.options import AsJson, require_tree


def dst(
    seeds: Annotated[
        int, typer.Option(metavar="N", min=1, help="How many; of a single one the event log is shown.")
    ] = 100,
    seed: Annotated[int, typer.Option(metavar="K", min=0, help="The first of them.")] = 0,
    jobs: Annotated[int, typer.Option(metavar="J", min=1, help="Processes.")] = os.cpu_count() or 1,
    as_json: AsJson = False,
) -> None:
    """Deterministic simulation of the command path, 20 s a seed, with faults drawn from the seed.

    Exit code: 0 no invariant is violated; 1 one is: the event log of each such seed is shown.
    """
    require_tree("dst")
    from giraff_cli.dst.explore import explore  # noqa: PLC0415

    raise typer.Exit(explore(seeds, seed, jobs, as_json=as_json))
