"""Keys on disk: nobody else can read one at any moment, and what is interrupted leaves the old or the new, whole."""

import json
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from giraff_setup.keys.manage import RefusedError, statuses
from tests.rules.repository import ROOT
from tests.unit.keys.folders import NOW, authority, bundle, contents


def interrupted(root: Path, umask: int, word: str) -> tuple[list[str], list[str]]:
    """The operations of a whole run, and the keys that were exposed meanwhile."""
    command = [sys.executable, "-m", "tests.functional.keys.interrupted", str(root), f"{umask:o}", word]
    run = subprocess.run(command, check=False, capture_output=True, text=True, cwd=ROOT)
    assert run.returncode == 0, run.stderr
    seen = json.loads(run.stdout)
    return seen["operations"], seen["exposed"]


def trees(root: Path) -> list[Path]:
    """What was left by those that were killed, and last by the one that was not."""
    return sorted((path for path in root.iterdir() if path.name.isdigit()), key=lambda path: int(path.name))


def exposed(tree: Path) -> list[Path]:
    return [path for path in tree.rglob("*.key") if path.stat().st_mode & 0o777 != 0o600]


@pytest.mark.parametrize("umask", [0o000, 0o777], ids=oct)
def test_a_first_making_that_is_killed_at_any_operation_leaves_nothing_or_all(tmp_path: Path, umask: int) -> None:
    operations, ever_exposed = interrupted(tmp_path, umask, "make")
    assert len(operations) > 12, operations
    assert ever_exposed == []
    for tree in trees(tmp_path):
        folder = tree / "keys"
        if folder.exists():
            assert statuses(folder, NOW)[0].state == "ok"
            bundle(folder, renew=(folder / "robot").exists())
        else:
            bundle(authority(folder))
        [robot] = statuses(folder, NOW)[1]
        assert robot.state == "ok"
        assert sorted(path.name for path in tree.iterdir()) == ["keys"]
        assert sorted(path.name for path in folder.iterdir()) == [".gitignore", "ca.key", "ca.pem", "robot"]
        assert exposed(tree) == []
        assert {path.stat().st_mode & 0o777 for path in (folder, folder / "robot")} == {0o700}


def test_a_renewal_that_is_killed_at_any_operation_leaves_the_old_or_the_new_bundle(tmp_path: Path) -> None:
    operations, ever_exposed = interrupted(tmp_path, 0o022, "renew")
    assert operations.count("os.rename") == 2, operations
    assert ever_exposed == []
    was = contents(tmp_path / "before" / "keys" / "robot")
    renewed = []
    for tree in trees(tmp_path):
        [robot] = statuses(tree / "keys", NOW)[1]  # also takes up what was left
        assert robot.state == "ok", tree
        renewed.append(contents(tree / "keys" / "robot") != was)
        assert sorted(path.name for path in (tree / "keys").iterdir()) == [".gitignore", "ca.key", "ca.pem", "robot"]
    assert renewed == sorted(renewed), "once it is the new one it stays so"
    assert renewed[0] is False
    assert renewed[-1] is True


def test_of_two_at_once_one_makes_it_and_the_other_is_refused(tmp_path: Path) -> None:
    folder = authority(tmp_path / "keys")
    results: list[str] = []

    def make(act: Callable[..., Any], *arguments: Any) -> None:
        try:
            act(*arguments)
            results.append("made")
        except RefusedError:
            results.append("refused")

    for act, arguments in ((bundle, (folder,)), (authority, (tmp_path / "other",))):
        results.clear()
        threads = [threading.Thread(target=make, args=(act, *arguments)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert sorted(results) == ["made", "refused", "refused", "refused"]
