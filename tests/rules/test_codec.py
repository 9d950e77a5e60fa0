"""The committed codec is what the protocol header gives."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from tests.rules.repository import ROOT
from tests.support.tools import finished

HEADER = Path("firmware/common/protocol.h")
GENERATOR = Path("firmware/generate_codec.py")
CODEC = Path("schemas/giraff_schemas/wire.py")


def check(tree: Path) -> tuple[int, str]:
    """Exit code and words of the generator."""
    run = finished([sys.executable, tree / GENERATOR, "--check"])
    return run.returncode, run.stdout + run.stderr


def test_the_codec_is_generated_from_the_header() -> None:
    code, words = check(ROOT)
    assert code == 0, words


def test_an_edited_codec_shows(tmp_path: Path) -> None:
    for path in (HEADER, GENERATOR, CODEC):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    assert check(tmp_path)[0] == 0
    with (tmp_path / CODEC).open("a") as codec:
        codec.write("EXTRA = 1\n")
    assert check(tmp_path)[0] != 0
