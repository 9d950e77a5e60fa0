"""A service that does not exist is not started, and the right name is suggested."""

from unittest.mock import MagicMock

import pytest

from giraff_node import start as subject
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


def test_a_robot_file_that_a_service_refuses_ends_it_with_2(monkeypatch: pytest.MonkeyPatch) -> None:
    node = MagicMock()
    monkeypatch.setattr(subject, "Node", node)
    monkeypatch.setattr(subject, "build", MagicMock(side_effect=ValueError("it has a sensor of no known type")))
    node.return_value.__exit__.return_value = False
    with pytest.raises(SystemExit, match="2"):
        subject.start("guard")
    log = node.return_value.__enter__.return_value.log
    assert "no known type" in str(log.error.call_args)
