"""Makes and renews keys again and again, each time killed one file operation later; a process of its own for it.

Before each operation every private key below the tree is looked at. Prints, as JSON, the operations of an undisturbed
run and the keys that others could read at any moment.
"""

import json
import os
import shutil
import signal
import sys
from itertools import count
from pathlib import Path

from tests.unit.keys.folders import authority, bundle

OPERATIONS = {"open", "os.mkdir", "os.chmod", "os.rename", "os.rmdir", "os.remove"}


class Hook:
    """Sees each file operation before it is done."""

    def __init__(self, tree: Path, fatal: int) -> None:
        self.tree = tree
        self.fatal = fatal
        self.operations: list[str] = []
        self.exposed: set[str] = set()
        self._looking = False

    def __call__(self, event: str, _arguments: tuple[object, ...]) -> None:
        if event not in OPERATIONS or self._looking:
            return
        self._looking = True
        self.exposed |= {str(path) for path in self.tree.rglob("*.key") if path.stat().st_mode & 0o077}
        self._looking = False
        self.operations.append(event)
        if len(self.operations) == self.fatal:
            os.kill(os.getpid(), signal.SIGKILL)


def attempt(tree: Path, umask: int, fatal: int, *, renew: bool) -> bool:
    """Whether it got to its end; then it has printed what it saw."""
    child = os.fork()
    if child:
        return os.waitpid(child, 0)[1] == 0
    os.umask(umask)
    hook = Hook(tree, fatal)
    sys.addaudithook(hook)
    if renew:
        bundle(tree / "keys", renew=True)
    else:
        bundle(authority(tree / "keys"))
    print(json.dumps({"operations": hook.operations, "exposed": sorted(hook.exposed)}), flush=True)
    os._exit(0)


def main(root: Path, umask: int, *, renew: bool) -> None:
    """Leaves one tree for each operation at which it was killed, called by the operation's number, and a whole one."""
    before = root / "before"
    before.mkdir()
    if renew:
        bundle(authority(before / "keys"))
    for fatal in count(1):
        tree = root / str(fatal)
        shutil.copytree(before, tree)
        if attempt(tree, umask, fatal, renew=renew):
            return


main(Path(sys.argv[1]), int(sys.argv[2], 8), renew=sys.argv[3] == "renew")
