"""What is typed wrong is told in one line, whichever command it is."""

from __future__ import annotations

import pytest

from tests.unit.cli.typed import typed


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("tpic", "giraff: no such command 'tpic'. Did you mean 'topic'? (see giraff --help)"),
        ("topic eco odom", "giraff topic: no such command 'eco'. Did you mean 'echo'? (see giraff topic --help)"),
        ("top --onec", "giraff top: no such option: --onec (Possible options: --connect, --json, --once) (see"),
        ("topic echo", "giraff topic echo: missing argument 'KEY' (see giraff topic echo --help)"),
        ("doctor extra", "giraff doctor: got unexpected extra argument(s) (extra) (see giraff doctor --help)"),
        ("estop status --timeout", "giraff estop status: option '--timeout' requires an argument (see"),
        ("estop status --timeout inf", "giraff estop status: invalid value for '--timeout': inf is no number"),
        ("watch --for inf", "giraff watch: invalid value for '--for': inf is no number to count with"),
        ("watch --for -1", "giraff watch: invalid value for '--for': "),
        ("watch --for nan", "giraff watch: invalid value for '--for': "),
        ("why --for soon --json", "giraff why: invalid value for '--for': "),
        ("topic pub battery {} --rate 1e9", "giraff topic pub: invalid value for '--rate': "),
        ("record --max-size 7", "giraff record: invalid value: --max-size 7: give 100k at least"),
        ("dst --seeds 0", "giraff dst: invalid value for '--seeds': "),
    ],
)
def test_it_takes_a_line_whatever_the_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: str, line: str
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    code, out, err = typed(monkeypatch, capsys, *words.split())
    assert (code, out) == (2, "")
    assert err.startswith(line)
    assert err.count("\n") == 1
    assert err.endswith(" --help)\n")


@pytest.mark.parametrize("words", ["", "topic"])
def test_a_word_that_wants_another_shows_its_help(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: str
) -> None:
    code, out, err = typed(monkeypatch, capsys, *words.split())
    assert (code, err) == (2, "")
    assert "Commands" in out
