"""`giraff encoder disk` writes a drawing that is read as the disk that was asked for, and overwrites nothing."""

from pathlib import Path

from giraff_core.encoder_disk import read_pattern
from tests.unit.cli.typed import Giraff


def test_it_writes_a_drawing_once(tmp_path: Path, giraff: Giraff) -> None:
    file = tmp_path / "disk.svg"
    code, out, _ = giraff("encoder", "disk", str(file), "--pairs", "20")
    assert code == 0
    assert "A turn of the disk is 80 states." in out
    assert "ticks_per_metre = 40 x G / " in out
    text = file.read_text()
    assert read_pattern(text).states_per_turn == 80
    code, _, complaint = giraff("encoder", "disk", str(file))
    assert (code, file.read_text()) == (2, text)
    assert f"{file} is there already: name another file" in complaint
    code, _, complaint = giraff("encoder", "disk", str(tmp_path / "no" / "disk.svg"))
    assert (code, "cannot be written: No such file or directory" in complaint) == (2, True)


def test_without_a_file_it_prints_the_drawing_alone(giraff: Giraff) -> None:
    code, out, _ = giraff("encoder", "disk")
    assert (code, read_pattern(out).states_per_turn) == (0, 160)
