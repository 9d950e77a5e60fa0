"""Drives, looked for on their maps, on all processors; as a program, one line a kind, for whoever tunes.

python -m tests.campaign.localization --kinds global,kidnapped --seeds 4 --first 0
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor

import msgspec

from giraff_localization.config import LocalizationConfig
from tests.loop.localization.judging import Run, Verdict, line, verdict
from tests.loop.localization.kinds import DEFAULTS, KINDS, run


def verdicts(
    names: Sequence[str], seeds: Sequence[int], config: LocalizationConfig = DEFAULTS, jobs: int | None = None
) -> Iterator[tuple[str, Verdict, list[Run]]]:
    """Of each kind, as soon as it is there."""
    with ProcessPoolExecutor(jobs) as pool:
        coming = {name: [pool.submit(_run, name, config, seed) for seed in seeds] for name in names}
        for name, futures in coming.items():
            runs = [future.result() for future in futures]
            yield name, verdict(runs, tracks=KINDS[name].tracks), runs


def _run(name: str, config: LocalizationConfig, seed: int) -> Run:
    return run(KINDS[name], seed, config, time.process_time)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--seeds", type=int, default=4, help="how many")
    parser.add_argument("--first", type=int, default=0, help="the first of them")
    parser.add_argument("--jobs", type=int, help="processes; all processors unless given")
    parser.add_argument("--set", nargs="*", default=[], help="fields of [localization], as most_particles=20000")
    parser.add_argument("--each", action="store_true", help="one line for each drive too")
    given = parser.parse_args()
    names = given.kinds.split(",")
    if unknown := [name for name in names if name not in KINDS]:
        parser.error(f"there is no kind {', '.join(unknown)}; there are {', '.join(KINDS)}")
    fields = dict(field.split("=", 1) for field in given.set)
    config = msgspec.convert(fields, LocalizationConfig, strict=False)
    for name, found, runs in verdicts(names, range(given.first, given.first + given.seeds), config, given.jobs):
        if given.each:
            for each in runs:
                print(line(f"  {each.seed}", verdict([each], tracks=KINDS[name].tracks)), flush=True)
        print(line(name, found), flush=True)


if __name__ == "__main__":
    main()
