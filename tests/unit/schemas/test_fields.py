"""The fields of a sample in the words of its source."""

from typing import Any

import pytest

from giraff_schemas.camera import VisualOdometry
from giraff_schemas.fields import Field, fields_of
from giraff_schemas.health import Health
from giraff_schemas.messages import Battery, Odometry
from giraff_schemas.topics import TOPICS, Topic


def test_a_field_has_its_type_and_its_unit() -> None:
    assert fields_of(Battery)[3] == Field("voltage", "float", "V.")
    assert [field.name for field in fields_of(Battery)] == ["seq", "stamp_ns", "instance", "voltage", "since_charge"]
    assert "float[6]" in [field.type for field in fields_of(Odometry)]
    types = {field.name: field.type for field in fields_of(VisualOdometry)}
    assert (types["motion"], types["tracked"]) == ("float[3] | None", "tuple[int[2], ...]")
    assert fields_of(Health)[0] == Field("service", "str", "")


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.key)
def test_every_field_is_told(topic: Topic[Any]) -> None:
    assert {field.name for field in fields_of(topic.schema)} == set(topic.schema.__struct_fields__)
