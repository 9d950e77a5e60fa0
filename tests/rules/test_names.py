"""Names that were given up for plainer ones do not come back.

A definition, a field, an attribute or an alias counts; a parameter or a local variable may be called as reads best.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from tests.rules.repository import ROOT, SOURCE_ROOTS, name, sources

MOST: Final = {"take": 0, "tell": 2, "look": 0, "hear": 0}
"""Functions whose names say nothing of their effect."""
VAGUE: Final = re.compile(rf"\bdef _*({'|'.join(MOST)})\(")

EVERYWHERE: Final = SOURCE_ROOTS
GUARD: Final = ("services/giraff_guard",)
ULTRASONIC: Final = ("services/giraff_guard/senses/ultrasonic",)
DRIVES: Final = "services/giraff_base/drive.py", "services/giraff_base/drives"
DISCOVERY: Final = "services/giraff_node/network/discovery.py", "services/giraff_node/network/consent.py"
SEGMENTS: Final = (
    "schemas/giraff_schemas/messages.py",
    "services/giraff_cli/calibrate",
    "services/giraff_cli/localize",
    "services/giraff_cli/run",
    "services/giraff_core/kinematics",
    "services/giraff_client",
    "services/giraff_motion",
    "services/giraff_telemetry",
    "services/giraff_vision",
    "services/giraff_viewer",
    "services/giraff_web",
)

TABLE: Final[tuple[tuple[str, tuple[str, ...]], ...]] = (
    # Things of the robot and of its simulation, named by a metaphor.
    ("Befall Drill Soldering Soldered solder Story Contrary Touching Wishes Caretaker caretaker typist", EVERYWHERE),
    ("befalls story challenger twins doorman soldering contrary standing", EVERYWHERE),
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
)
MODULES: Final = frozenset(
    {
        *("way", "kinds", "moved", "readable", "misplaced", "soldering", "soldered", "contrary", "touching", "wishes"),
        *("story", "drill", "doorman", "challenger", "twins", "authority", "freedom", "origin", "typist", "asked"),
    }
)


FIELDS: Final = re.compile(
    r"\b(way_out|maker_silence|unproved_linear|held_(range|time|radius|beside|block)|"
    r"proof_(time|travel|turn)|fade_(time|travel))\b"
)
"""Fields of messages and robot files that are renamed, in texts for people and in the page."""


def modules(*places: str) -> Iterator[Path]:
    for place in places:
        found = [path for path in sources(".py", under=EVERYWHERE) if f"{name(path)}/".startswith(f"{place}/")]
        assert found, f"there is no {place} any more: correct the table"
        yield from found


def targets(node: ast.AST) -> list[ast.expr]:
    """Return what a statement of a module or a class gives a value."""
    return node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []


def names(source: str) -> Iterator[tuple[int, str]]:
    """Yield each definition, field, attribute and alias of a module, without leading underscores."""
    for node in ast.walk(ast.parse(source)):
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


def left(words: str, places: tuple[str, ...]) -> Iterator[str]:
    """Yield the places that have one of these names. A file without a line that may be one is not parsed."""
    any_of = "|".join(words.split())
    may_be = re.compile(rf"\b(def|class|as) _*({any_of})\b|\._*({any_of})\b|^ *_*({any_of})\b *[:=]", re.MULTILINE)
    for path in modules(*places):
        if may_be.search(source := path.read_text("utf-8")):
            yield from (f"{name(path)}:{line}: {it}" for line, it in names(source) if it in words.split())


def test_no_name_that_was_given_up_is_back() -> None:
    found = [each for words, places in TABLE for each in left(words, places)]
    found += [name(path) for path in modules(*EVERYWHERE) if path.stem in MODULES]
    assert not found, "\n".join(["name it otherwise:", *found])


def test_no_page_for_people_names_a_field_that_is_gone() -> None:
    texts = [
        *sources(".md", ".toml", ".yml", under=("docs", "deploy")),
        *sources(".js", ".css", ".html", under=SOURCE_ROOTS),
    ]
    texts += [path for path in sources(".md") if path.parent == ROOT]
    found = ((path, each.group()) for path in texts for each in FIELDS.finditer(path.read_text("utf-8")))
    assert [f"{name(path)}: {each}" for path, each in found] == []


def test_a_function_is_named_by_its_effect() -> None:
    found = Counter(each for path in modules(*EVERYWHERE) for each in VAGUE.findall(path.read_text("utf-8")))
    assert found == {word: count for word, count in MOST.items() if count}


def test_each_kind_of_name_is_found() -> None:
    source = "import a as it\nclass _Bond:\n    maker: int\n    def hurry(self):\n        self._near = 1\nWay = int\n"
    assert {word for _, word in names(source)} == {"it", "Bond", "maker", "hurry", "near", "Way"}
