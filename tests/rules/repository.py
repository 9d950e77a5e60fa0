"""The repository as the rules see it: its files, its packages, its declared dependencies."""

import ast
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from giraff_schemas.services import SERVICES
from tests.support.tools import finished

ROOT = Path(__file__).resolve().parents[2]
SOURCE_ROOTS = ("schemas", "services")


@cache
def files() -> tuple[Path, ...]:
    """Every file that is, or would be, in the repository; ignored ones are nobody's business."""
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    output = finished(listing, cwd=ROOT, check=True).stdout
    paths = (ROOT / name for name in output.split("\0") if name)
    return tuple(sorted(path for path in paths if path.is_file()))


def sources(*suffixes: str, under: tuple[str, ...] = ()) -> list[Path]:
    """Files of these suffixes, in these top-level directories or anywhere."""
    return [
        path for path in files() if path.suffix in suffixes and (not under or path.relative_to(ROOT).parts[0] in under)
    ]


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def imported_by(source: str, *words: str) -> set[str]:
    """Return what a module imports, anywhere in it: `import a.b` and `from a import b` are `a.b`.

    `words`: a source that has none of these is not parsed, since that takes time. None: each is.
    """
    tree = ast.parse(source if not words or any(word in source for word in words) else "")
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    return {f"{getattr(node, 'module', '')}.{alias.name}".lstrip(".") for node in nodes for alias in node.names}


def packages() -> list[str]:
    """Import packages of both source roots."""
    return sorted(init.parent.name for root in SOURCE_ROOTS for init in (ROOT / root).glob("giraff_*/__init__.py"))


def services() -> list[str]:
    """Packages of the services."""
    return sorted(service.package for service in SERVICES if service.package)


def contracts() -> str:
    """Who may import whom, as import-linter reads it: with the names for which imports.toml has a word."""
    text = (ROOT / "tests" / "rules" / "imports.toml").read_text()
    for word, names in (("EACH PACKAGE", packages()), ("EACH SERVICE", services())):
        text = text.replace(f'"{word}"', ", ".join(f'"{name}"' for name in names))
    return text.replace("ANY SERVICE", " | ".join(services()))


def pyproject() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())
