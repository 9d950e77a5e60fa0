"""docs/structure.md shows the packages as they are, and docs/README.md names every page.

`GIRAFF_WRITE_DOCS=1 pytest tests/rules/test_structure.py` draws the picture anew.
"""

import os
import re
from collections import Counter
from itertools import pairwise

import grimp

from tests.rules.repository import ROOT, files, name, packages, sources
from tests.rules.structure_picture import PICTURE, draw, placed

MOST_MODULES = 24


def test_the_picture_is_of_these_imports() -> None:
    if os.environ.get("GIRAFF_WRITE_DOCS"):
        PICTURE.write_text(draw())
    assert PICTURE.read_text() == draw()


def test_no_arrow_runs_through_a_box() -> None:
    boxes, arrows, width, _ = placed()
    steps = [each / 400 for each in range(1, 400)]
    for (ax, ay), (bx, by) in [piece for arrow in arrows for piece in pairwise(arrow)]:
        points = [(ax + (bx - ax) * step, ay + (by - ay) * step) for step in steps]
        assert [name for name, box in boxes.items() if any(box.holds(*point) for point in points)] == []
        assert 0 < bx < width


def test_a_script_is_checked_against_the_types_of_all_that_it_is_made_of() -> None:
    graph = grimp.build_graph(*packages(), cache_dir=None)
    made_of = graph.find_upstream_modules("giraff_client", as_package=True)
    roots = {module.partition(".")[0] for module in made_of} | {"giraff_client"}
    assert {path.parent.name for path in files() if path.name == "py.typed"} == roots


def test_no_folder_is_too_large_to_hold_in_the_head() -> None:
    folders = Counter(path.parent for path in sources(".py", under=("services", "schemas")))
    assert {name(folder): count for folder, count in folders.items() if count > MOST_MODULES} == {}


def test_the_index_names_every_page() -> None:
    docs = ROOT / "docs"
    named = re.findall(r"\]\(([\w-]+\.md)\)", (docs / "README.md").read_text())
    assert set(named) == {path.name for path in docs.glob("*.md")} - {"README.md"}
