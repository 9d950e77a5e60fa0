"""Breaks a safety rule in a copy of the tree, and runs the test that must notice.

`mutants.toml` lists the rules, how each is broken and who notices. The tree itself is never touched.
"""

import os
import shutil
import sys
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import msgspec

from tests.rules.repository import ROOT, files, packages
from tests.support.tools import Finished, finished

LIST: Final = Path(__file__).with_name("mutants.toml")
_TESTS_FAILED: Final = 1  # pytest's exit status; every other one but 0 says that no test has judged


class Mutant(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One way to break one rule."""

    rule: str
    """What holds, in one line."""
    file: str
    old: str
    """Text that occurs once in `file`."""
    new: str
    killed_by: str
    """Node id of the test that fails without the rule."""


class MutantError(Exception):
    """An entry of the list that breaks nothing, or a copy of the tree in which nothing can be tried."""


def read_mutants() -> list[Mutant]:
    return msgspec.convert(tomllib.loads(LIST.read_text())["mutant"], list[Mutant])


def mutated(text: str, mutant: Mutant) -> str:
    """`text`, the content of the mutant's file, with its rule broken."""
    found = text.count(mutant.old)
    if found != 1:
        raise MutantError(f"{mutant.file}: {mutant.old!r} occurs {found} times, not once; adapt {LIST.name}")
    if mutant.old == mutant.new:
        raise MutantError(f"{mutant.file}: {mutant.old!r} is not changed")
    return text.replace(mutant.old, mutant.new)


class Laboratory:
    """A copy of the tree with boards of its own, run by this environment's interpreter."""

    def __init__(self, directory: Path) -> None:
        self._root = directory
        for path in files():
            copy = directory / path.relative_to(ROOT)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, copy)
        self._environment = {name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")} | {
            # Before the editable installation, which is of the tree that is copied.
            "PYTHONPATH": os.pathsep.join(str(directory / root) for root in ("schemas", "services")),
            # A compiled file counts as current by its second and size, which many mutants leave as they are.
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        self._require_own_packages()
        self._make("firmware", "host")
        self._make("services/giraff_sim/lockstep")

    def require_whole(self, tests: Iterable[str]) -> None:
        """MutantError unless all of these tests pass with no rule broken."""
        done = self._pytest(*sorted(set(tests)))
        if done.returncode:
            raise MutantError(f"with all rules whole:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")

    def passes(self, test: str) -> bool:
        """Whether a test passes in the copy as it is now; MutantError when it could not judge."""
        done = self._pytest("-x", test)
        if done.returncode not in (0, _TESTS_FAILED):
            raise MutantError(f"{test} did not judge:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.returncode == 0

    @contextmanager
    def broken(self, mutant: Mutant) -> Iterator[None]:
        """The copy with a rule broken, until the block ends."""
        path = self._root / mutant.file
        sound = path.read_text()
        path.write_text(mutated(sound, mutant))
        try:
            self._build_if_c(path)
            yield
        finally:
            path.write_text(sound)
            self._build_if_c(path)

    def _build_if_c(self, path: Path) -> None:
        if path.suffix in (".c", ".h"):
            self._make("firmware", "host")

    def _make(self, folder: str, *targets: str) -> None:
        made = self._finished(["make", "--silent", "-C", folder, *targets, f"BUILD={self._root / 'build'}"])
        if made.returncode:
            raise MutantError(f"{folder} does not build:\n{made.stderr[-2000:]}")

    def _require_own_packages(self) -> None:
        """Every package must be the copy's: of another one the mutants would be tried on sound code."""
        names = packages()
        where = "; ".join(f"print(__import__({name!r}).__file__)" for name in names)
        done = self._finished([sys.executable, "-c", where])
        found = [Path(line) for line in done.stdout.splitlines()]
        if len(found) != len(names) or not all(path.is_relative_to(self._root) for path in found):
            raise MutantError(f"not the copy's packages are imported: {done.stdout}{done.stderr}")

    def _pytest(self, *words: str) -> Finished:
        return self._finished([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--timeout=60", *words])

    def _finished(self, command: list[str]) -> Finished:
        return finished(command, cwd=self._root, env=self._environment)
