"""What builds and checks this repository, run to its end: git, make, compilers, linters, an interpreter of its own.

Nothing of a robot is run here; tests of real processes start theirs themselves.
"""

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

Finished = subprocess.CompletedProcess[str]


def finished(
    command: Sequence[str | Path], *, cwd: Path | None = None, env: Mapping[str, str] | None = None, check: bool = False
) -> Finished:
    """How it ended and what it said. `check`: AssertionError with what it complained of unless it ended well."""
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=cwd, env=env)
    if check:
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done
