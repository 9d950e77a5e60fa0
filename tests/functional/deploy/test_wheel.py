"""The wheel holds all that its verbs read; those that need the repository's tree say so."""

import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

from giraff_sim.board import ROOT

_TYPE = "import sys; sys.path.insert(0, sys.argv.pop(1)); from giraff_cli.start import main; main()"
_ROOM = str(ROOT / "deploy" / "worlds" / "living_room.toml")


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*build, "--wheel-dir", folder, str(ROOT)], check=True, capture_output=True)
    [wheel] = folder.glob("giraff-*.whl")
    ZipFile(wheel).extractall(folder / "unpacked")
    return folder / "unpacked"


def test_it_holds_the_packages_whole_and_nothing_else(unpacked: Path) -> None:
    kept = {path.relative_to(unpacked).as_posix() for path in unpacked.rglob("*") if path.is_file()}
    made = {
        path.relative_to(ROOT / top).as_posix()
        for top in ("schemas", "services")
        for path in (ROOT / top).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {name for name in kept if ".dist-info/" not in name} == made
    assert {"giraff_node/zenoh/peer.toml", "giraff_web/page/index.html"} <= kept


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("map", "show", _ROOM), 0, "origin"),
        (("estop", "status", "--timeout", "0.1"), 2, "no robot is heard on the network"),
        (("run",), 2, "giraff run: the simulated robot needs the repository's tree, which is not here; clone"),
    ],
    ids=["map", "estop", "run"],
)
def test_a_verb_of_it_does_its_work_or_says_what_to_do(
    words: tuple[str, ...], code: int, said: str, unpacked: Path, tmp_path: Path
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _TYPE, str(unpacked), *words],
        cwd=tmp_path,
        env={"PATH": "/nowhere", "GIRAFF_NETWORK_LOCAL": "true"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code, done.stderr
    assert said in (done.stderr if code else done.stdout)
    assert len(done.stderr.splitlines()) == (1 if code else 0)
