"""`giraff dst`: deterministic simulation of the command path, and the event log of each seed that fails."""

import time

from rich.console import Console

from giraff_sim.dst.many import Totals, run_many, unreached
from giraff_sim.dst.scenarios import KINDS
from giraff_sim.dst.simulated_run import SECONDS, Outcome
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.progress import Progress

_FAILED = 1  # exit code


def explore(seeds: int, first: int, jobs: int, *, as_json: bool) -> int:
    """Run `seeds` seeds from `first` on; return the exit code.

    `as_json`: the totals are printed as one document, and the rest goes to standard error.
    """
    console = Console(highlight=False, stderr=as_json)
    totals = Totals()
    began = time.monotonic()
    with Progress("seeds", seeds, shown=not as_json) as progress:
        for outcome in run_many(range(first, first + seeds), jobs):
            totals.add(outcome, SECONDS)
            if outcome.violations or seeds == 1:
                progress.hide()
                _print_outcome(console, outcome)
            progress.move(totals.seeds)
    _sum_up(console, totals, time.monotonic() - began)
    if as_json:
        print_json(totals)
    return _FAILED if totals.failures else 0


def _print_outcome(console: Console, outcome: Outcome) -> None:
    console.print(f"\nseed {outcome.seed}: {outcome.path:.2f} m driven, {outcome.contacts} contacts", style="bold")
    for line in outcome.events:
        console.print(line, style="red" if "VIOLATION" in line else None, markup=False, soft_wrap=True)
    digests = f"motion {outcome.motion_digest}, events {outcome.event_digest}"
    console.print(f"{digests}; again with: giraff dst --seeds 1 --seed {outcome.seed}", soft_wrap=True)


def _sum_up(console: Console, totals: Totals, seconds: float) -> None:
    for title, prefix in (("faults", "fault: "), ("stops", "stop: ")):
        console.print(f"\n{title}", style="bold")
        for name, count in totals.counts.most_common():
            if name.startswith(prefix):
                console.print(f"{count:7d}  {name.removeprefix(prefix)}", markup=False, soft_wrap=True)
    if never := unreached(totals.counts, KINDS):
        console.print("\nnever reached by these seeds", style="bold")
        for mark in never:
            console.print(f"         {mark}", markup=False)
    failed = len(totals.failures)
    console.print(
        f"\nseeds: {totals.seeds}, {totals.simulated:g} s simulated in {seconds:.1f} s; the robot drove in "
        f"{totals.drove} of them, {totals.path:.0f} m, {totals.near:.0f} m of it within half a metre of something, was "
        f"granted {totals.counts['granted']} times, armed {totals.counts['armed']} times and touched something "
        f"{totals.contacts} times; motion {totals.motion_digest[:16]}, events {totals.event_digest[:16]}",
        soft_wrap=True,
    )
    console.print(
        f"seeds that violate an invariant: {failed}" if failed else "no invariant is violated",
        style="bold red" if failed else "bold green",
    )
