"""The example of "Add a sense": the ring is added to a copy of the tree, where its own test then runs."""

import os
import shutil
import sys
import tomllib
from pathlib import Path
from typing import Final

from tests.rules.repository import ROOT
from tests.support.tools import finished

EXAMPLE: Final = ROOT / "examples" / "sense_ring"
COPIED: Final = (
    *("schemas", "services", "deploy/robot.toml", "docker-compose.yml", "pyproject.toml"),
    *("tests/loop/loops.py", "tests/sim/robots.py", "tests/support/robots.py"),
)
LINKED: Final = ("build", "firmware")
CACHES: Final = shutil.ignore_patterns("__pycache__")


def copy(name: str, tree: Path) -> None:
    (tree / name).parent.mkdir(parents=True, exist_ok=True)
    if (ROOT / name).is_dir():
        shutil.copytree(ROOT / name, tree / name, ignore=CACHES)
    else:
        shutil.copy2(ROOT / name, tree / name)


def insert(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.count(old) == 1, f"{file.name}: {old!r} occurs {text.count(old)} times: adapt existing.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")


def test_a_ring_that_is_added_as_the_page_says_keeps_its_robot_from_walls(tmp_path: Path) -> None:
    for name in COPIED:
        copy(name, tmp_path)
    for name in LINKED:
        (tmp_path / name).symlink_to(ROOT / name)
    for entry in tomllib.loads((EXAMPLE / "existing.toml").read_text(encoding="utf-8"))["insertion"]:
        insert(tmp_path / entry["file"], entry["old"], entry["new"])
    added = [path.relative_to(EXAMPLE) for path in EXAMPLE.rglob("*.py")]
    assert not [str(path) for path in added if (tmp_path / path).exists()], "these files are there already"
    shutil.copytree(EXAMPLE, tmp_path, ignore=CACHES, dirs_exist_ok=True)
    [test] = (str(path) for path in added if path.name.startswith("test_"))
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")} | {
        "PYTHONPATH": os.pathsep.join(str(tmp_path / root) for root in ("schemas", "services"))
    }
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--timeout=60", test]
    done = finished(command, cwd=tmp_path, env=environment)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
