"""What a service takes samples out of, and what it writes to its log."""

import json
import logging

import pytest

from giraff_node import Inbox
from giraff_node.process.logs import service_logger
from giraff_schemas.messages import Battery


def battery(voltage: float) -> Battery:
    return Battery(voltage=voltage)


def test_an_inbox_gives_each_sample_once_in_its_order() -> None:
    inbox: Inbox[Battery] = Inbox(10)
    for voltage in (1.0, 2.0, 3.0):
        inbox.accept(battery(voltage))
    assert [sample.voltage for sample in inbox.pop_all()] == [1.0, 2.0, 3.0]
    assert list(inbox.pop_all()) == []


def test_a_full_inbox_loses_the_oldest() -> None:
    inbox: Inbox[Battery] = Inbox(3)
    for voltage in range(10):
        inbox.accept(battery(voltage))
    assert [sample.voltage for sample in inbox.pop_all()] == [7, 8, 9]


def test_a_sample_that_comes_while_others_are_taken_waits_for_the_next_turn() -> None:
    """A flood must not hold the loop."""
    inbox: Inbox[Battery] = Inbox(10)
    inbox.accept(battery(1.0))
    taken = []
    for sample in inbox.pop_all():
        taken.append(sample.voltage)
        inbox.accept(battery(sample.voltage + 1.0))
        assert len(taken) < 100
    assert taken == [1.0]
    assert [sample.voltage for sample in inbox.pop_all()] == [2.0]


def test_the_newest_is_the_last_one_or_none() -> None:
    newest: Inbox[Battery] = Inbox(1)
    assert list(newest.pop_all()) == []
    newest.accept(battery(1.0))
    newest.accept(battery(2.0))
    assert list(newest.pop_all()) == [battery(2.0)]


def test_each_entry_is_one_line_of_json_whatever_it_holds(capsys: pytest.CaptureFixture[str]) -> None:
    log = service_logger("test-logs")
    log.info('two\nlines, "quotes" and ä')
    log.warning("%s is %d", "x", 5)
    try:
        int("deep\nbelow")
    except ValueError:
        log.exception("it failed")
    log.debug("too small to tell")
    entries = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert [entry["level"] for entry in entries] == ["info", "warning", "error"]
    assert entries[0]["message"] == 'two\nlines, "quotes" and ä'
    assert entries[1]["message"] == "x is 5"
    assert "ValueError: invalid literal" in entries[2]["traceback"]
    assert {entry["service"] for entry in entries} == {"test-logs"}
    assert all(entry["time"].endswith("Z") for entry in entries)


def test_a_second_logger_of_a_service_does_not_double_its_lines(capsys: pytest.CaptureFixture[str]) -> None:
    service_logger("test-logs")
    service_logger("test-logs").info("once")
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not logging.getLogger("test-logs").propagate
