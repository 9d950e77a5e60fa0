"""Each committed codec is what its header gives."""

import shutil
import sys
from pathlib import Path

from tests.rules.repository import ROOT
from tests.support.tools import finished

HEADERS = tuple(
    Path("firmware") / name
    for name in (
        "common/protocol.h",
        "common/boards.h",
        "base/transitions_protocol.h",
        "ranger/bumper_protocol.h",
        "balancer/balancer_protocol.h",
    )
)
GENERATOR = Path("firmware/generate_codec.py")
CODECS = tuple(
    Path("schemas/giraff_schemas") / name
    for name in ("wire.py", "wires/boards.py", "wires/transitions.py", "wires/bumper.py", "wires/balancer.py")
)


def check(tree: Path) -> tuple[int, str]:
    """Exit code and words of the generator."""
    run = finished([sys.executable, tree / GENERATOR, "--check"])
    return run.returncode, run.stdout + run.stderr


def test_the_codec_is_generated_from_the_header() -> None:
    code, words = check(ROOT)
    assert code == 0, words


def test_each_edited_codec_shows(tmp_path: Path) -> None:
    for path in (*HEADERS, GENERATOR, *CODECS):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    for edited in CODECS:
        with (tmp_path / edited).open("a") as codec:
            codec.write("EXTRA = 1\n")
    code, words = check(tmp_path)
    assert code != 0
    assert [line.partition(" is not ")[0] for line in words.splitlines()] == [str(tmp_path / each) for each in CODECS]
