"""A service that does not exist is not started, and the right name is suggested."""

from __future__ import annotations

import pytest

from giraff_node.start import main


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["odometri"], "there is no service 'odometri'; did you mean 'odometry'?"),
        (["client"], "there is no service 'client'; known are: base, "),  # a script has a row, and no package
        ([], "give the name of one service; known are: base, "),
    ],
)
def test_what_is_no_service_is_refused(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert said in capsys.readouterr().err
