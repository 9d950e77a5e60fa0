"""The fault table that people read is the one that is tested, with the figures that were measured."""

from __future__ import annotations

from tests.campaign.fault_table import measured, newest_record, table, written


def test_the_page_has_the_table_of_the_scenarios_and_of_the_newest_campaign() -> None:
    record = newest_record()
    assert written() == table(measured(record) if record else {})
