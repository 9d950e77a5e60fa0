"""Names that were given up for plainer ones do not come back. CONTRIBUTING.md says how a thing is named here.

A definition, a field, an attribute or an alias counts; a parameter or a local variable may be called as reads best.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Final

ROOT: Final = next(each for each in Path(__file__).resolve().parents if (each / "services").is_dir())
MOST: Final = 5
"""Functions of one name that says nothing of their effect."""
VAGUE: Final = ("take", "tell", "look", "hear")

EVERYWHERE: Final = "services", "schemas"
GUARD: Final = ("services/giraff_guard",)
ULTRASONIC: Final = ("services/giraff_guard/ultrasonic",)
DRIVES: Final = "services/giraff_base/drive.py", "services/giraff_base/drives"
DISCOVERY: Final = "services/giraff_node/network/discovery.py", "services/giraff_node/network/consent.py"
SEGMENTS: Final = (
    "schemas/giraff_schemas/messages.py",
    "services/giraff_core/kinematics",
    "services/giraff_client",
    "services/giraff_motion",
    "services/giraff_vision",
    "services/giraff_viewer",
    "services/giraff_web",
)

TABLE: Final[tuple[tuple[str, tuple[str, ...]], ...]] = (
    # Things of the robot and of its simulation, named by a metaphor.
    ("Befall Drill Soldering Soldered solder Story Contrary Touching Wishes Caretaker caretaker typist", EVERYWHERE),
    ("Bond Challenger Twins Doorman Credit Grip Audience Presence Performance Passing PagesLooking", EVERYWHERE),
    ("Seen Found Asked Told LeasedStand Standing Way RobotWay Authority Binding", EVERYWHERE),
    ("Verdict Freedom freedom way_out PromptTimer hurry obey it is_level lose_level", EVERYWHERE),
    ("WELL", ("schemas",)),
    ("Work Stream", ("services/giraff_cli/top",)),
    # Fields and properties.
    ("maker_silence slowest regain unproved_linear held_range held_time held_radius held_beside", EVERYWHERE),
    ("held_block proof_time proof_travel proof_turn fade_time fade_travel knows_off forbids", EVERYWHERE),
    ("Motion near agreement maker authority", GUARD),
    ("doubt worth believed quiet surest", ULTRASONIC),
    ("waits notice", DRIVES),
    ("settle choose pick agree", DISCOVERY),
    ("origin", SEGMENTS),
    ("standing", ("services/giraff_cli/why", "services/giraff_cli/keys", "services/giraff_cli/commission")),
)
MODULES: Final = frozenset(
    {
        *("way", "kinds", "moved", "readable", "misplaced", "soldering", "soldered", "contrary", "touching", "wishes"),
        *("story", "drill", "doorman", "challenger", "twins"),
    }
)


def sources(*places: str) -> Iterator[Path]:
    for place in places:
        path = ROOT / place
        yield from [path] if path.is_file() else sorted(path.rglob("*.py"))


def targets(node: ast.AST) -> list[ast.expr]:
    """Return what a statement of a module or a class gives a value."""
    return node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []


def names(path: Path) -> Iterator[tuple[int, str]]:
    """Yield each definition, field, attribute and alias of a module, without leading underscores."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                yield node.lineno, node.name.lstrip("_")
            case ast.Attribute():
                yield node.lineno, node.attr.lstrip("_")
            case ast.alias() if node.asname:
                yield node.lineno, node.asname.lstrip("_")
            case ast.ClassDef() | ast.Module():
                if isinstance(node, ast.ClassDef):
                    yield node.lineno, node.name.lstrip("_")
                for target in (target for each in node.body for target in targets(each)):
                    if isinstance(target, ast.Name):
                        yield target.lineno, target.id.lstrip("_")


def test_no_name_that_was_given_up_is_back() -> None:
    left = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for words, places in TABLE
        for path in sources(*places)
        for line, name in names(path)
        if name in words.split()
    ]
    left += [str(path.relative_to(ROOT)) for path in sources(*EVERYWHERE) if path.stem in MODULES]
    assert not left, "\n".join(["name it otherwise:", *left])


def test_a_function_is_named_by_its_effect() -> None:
    found = Counter(
        node.name.lstrip("_")
        for path in sources(*EVERYWHERE)
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
    )
    vague = {name: found[name] for name in VAGUE}
    assert max(vague.values()) <= MOST, vague


if __name__ == "__main__":
    for test in (test_no_name_that_was_given_up_is_back, test_a_function_is_named_by_its_effect):
        try:
            test()
        except AssertionError as error:
            print(error)
