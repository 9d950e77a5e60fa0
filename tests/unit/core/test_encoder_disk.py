"""The drawing of an encoder's disk gives the edges that the disk is made for, and nothing else is taken for one."""

from pathlib import Path

import pytest

from giraff_core.encoder_disk import LONGEST, Disk, Pattern, drawing, read_pattern
from giraff_sim.bodies.registry import mirrored, read_disk

SECTORS = [line for line in drawing(Disk()).splitlines(keepends=True) if line.endswith('Z" fill="#000"/>\n')]
"""The black ones: 40 of the outer ring, then 40 of the inner one."""
HEAD = '<svg xmlns="http://www.w3.org/2000/svg">'


def rises(pattern: Pattern, channel: str) -> list[float]:
    """Return where a channel becomes high, as shares of a turn."""
    before = (pattern.edges[-1], *pattern.edges)
    return [
        edge.at
        for last, edge in zip(before, pattern.edges, strict=False)
        if getattr(edge, channel) and not getattr(last, channel)
    ]


def high_share(pattern: Pattern, channel: str) -> float:
    ends = [edge.at for edge in pattern.edges[1:]] + [pattern.edges[0].at + 1.0]
    return sum(end - edge.at for edge, end in zip(pattern.edges, ends, strict=True) if getattr(edge, channel))


def phase(pattern: Pattern) -> float:
    """Return by how many degrees of a pair B follows A."""
    first = rises(pattern, "a")[0]
    return min((at - first) % 1.0 for at in rises(pattern, "b")) * pattern.states_per_turn / 4 * 360


@pytest.mark.parametrize(
    "disk",
    [
        Disk(),
        Disk(offset=1 / 6, black=0.4),
        Disk(pairs=1, black=0.6),
        Disk(pairs=3, offset=0.8, black=0.7),
        Disk(pairs=94, outer=60.01),
        Disk(pairs=500, outer=300.0, inner=200.0, hole=100.0),
    ],
    ids=lambda disk: f"{disk.pairs},{disk.offset:.2g},{disk.black}",
)
def test_a_drawing_has_the_edges_of_its_disk(disk: Disk) -> None:
    pattern = read_pattern(drawing(disk))
    assert (pattern.states_per_turn, len(pattern.edges)) == (4 * disk.pairs, 4 * disk.pairs)
    assert phase(pattern) == pytest.approx(360 * disk.offset, abs=0.5)
    for channel in ("a", "b"):
        assert len(rises(pattern, channel)) == disk.pairs
        assert high_share(pattern, channel) == pytest.approx(disk.black, abs=0.001)


def test_a_sector_that_is_missing_takes_its_two_edges_along() -> None:
    text = drawing(Disk())
    whole, pattern = read_pattern(text), read_pattern(text.replace(SECTORS[7], ""))
    assert pattern.states_per_turn == 160
    gone = set(whole.edges) - set(pattern.edges)
    assert len(pattern.edges) == 158
    assert {edge.at for edge in gone} >= {7 / 40, 7.5 / 40}
    assert (len(rises(pattern, "a")), len(rises(pattern, "b"))) == (39, 40)


def test_a_mirrored_encoder_sees_the_disk_turn_the_other_way() -> None:
    states, edges = mirrored(read_pattern(drawing(Disk(offset=1 / 6, black=0.4))))
    seen = Pattern(states, tuple(edge._replace(b=not edge.b) for edge in edges))  # as the board's wiring inverts it
    assert len(edges) == 160
    assert phase(seen) == pytest.approx(360 - 60, abs=0.5)
    assert high_share(seen, "b") == pytest.approx(0.4, abs=0.001)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"pairs": 0}, "pairs is 0: it must be within 1..5000"),
        ({"pairs": 95}, "pairs is 95: at most 94 fit on an inner diameter of 30 mm"),
        ({"pairs": 1, "inner": 2.0, "hole": 1.0, "black": 0.01}, "pairs is 1: not even one fits"),
        ({"hole": 30.0}, "hole is 30 mm: it must be less than inner"),
        ({"outer": 41.0}, "outer is 41 mm: with inner 30 mm, it must be 42 at least"),
        ({"outer": float("nan")}, "outer is nan: it must be within"),
    ],
    ids=str,
)
def test_a_disk_that_cannot_be_is_refused(changes: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Disk(**changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "it is no SVG, or not all of one"),
        (drawing(Disk())[:9000], "it is no SVG, or not all of one"),
        (" " * (LONGEST + 1), "it is longer than"),
        ('<!DOCTYPE svg [<!ENTITY a "aaaa">]>' + HEAD + "&a;</svg>", "it declares a document type"),
        (HEAD + '<path d="M0 0h3" fill="#000"/></svg>', "it is no drawing of an encoder's disk"),
        (drawing(Disk()).replace("A29.0", "A28.0"), "a black part of it is no sector around its centre"),
        (drawing(Disk()).replace('cx="105"', 'cx="100"'), "a black part of it is no sector around its centre"),
        (drawing(Disk()).replace('cx="105"', 'cx="x"'), "its circles have no centre"),
        (drawing(Disk()).replace("Z", "z"), "a black part of it is no sector of a ring"),
        (drawing(Disk()).replace("<g ", '<g transform="scale(2)" '), "another program has moved or scaled"),
        (drawing(Disk()).replace("".join(SECTORS[:40]), ""), "rings of black sectors in it: 1, and"),
        (drawing(Disk()).replace(SECTORS[3], SECTORS[3] * 2), "black sectors of it touch"),
    ],
    ids=range(12),
)
def test_what_is_no_drawing_of_a_disk_is_refused(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        read_pattern(text)


@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "No such file"), (b"\xff\xfe", "it is no text"), (b"<svg", "not all of one")],
    ids=["missing", "no text", "torn"],
)
def test_the_simulator_names_the_file(content: bytes | None, said: str, tmp_path: Path) -> None:
    file = tmp_path / "disk.svg"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(ValueError, match=rf"^encoder_disk of \[sim\]: {file}.*{said}"):
        read_disk(str(file))
