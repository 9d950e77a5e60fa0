"""What the codec's generator reads, refuses and hashes."""

import importlib.util
import sys
from types import ModuleType

import pytest

from tests.firmware.builds import FIRMWARE


def load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("generate_codec", FIRMWARE / "generate_codec.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


generator = load()

HEADER = """
#define PACKED __attribute__((packed))
enum frame_type { FRAME_PING = 0x01 };  /* one */
enum { PERIOD_MS = 10 };
struct PACKED ping { uint8_t type; uint16_t seq; int32_t x; };
"""


def test_a_header_becomes_enums_constants_and_records() -> None:
    protocol = generator.parse(HEADER)
    assert [enum.members for enum in protocol.enums] == [{"FRAME_PING": 1}]
    assert protocol.constants == {"PERIOD_MS": 10}
    assert [record.fields for record in protocol.records] == [{"type": "uint8_t", "seq": "uint16_t", "x": "int32_t"}]


ARRAY = HEADER.replace("int32_t x;", "int32_t x; uint16_t y[PERIOD_MS];")


def test_the_last_field_may_be_an_array_of_as_many_as_a_constant_says() -> None:
    (record,) = generator.parse(ARRAY).records
    lines = generator.record_lines(record, "FrameType")
    assert '    layout: ClassVar[struct.Struct] = struct.Struct("<BHi10H")' in lines
    assert "    y: tuple[int, ...]" in lines
    assert "    x: int" in lines


def test_comments_and_white_space_do_not_change_the_hash() -> None:
    spread = HEADER.replace(" = ", "=").replace(";", ";  // what for\n").replace("/* one */", "/* two\n lines */")
    assert generator.protocol_hash(spread) == generator.protocol_hash(HEADER)


@pytest.mark.parametrize(
    ("old", "new"),
    [("int32_t x", "uint32_t x"), ("int32_t x", "int32_t y"), ("0x01", "0x02"), ("= 10", "= 20"), ("packed", "unused")],
)
def test_anything_else_changes_it(old: str, new: str) -> None:
    assert generator.protocol_hash(HEADER.replace(old, new)) != generator.protocol_hash(HEADER)


def test_a_header_beside_another_has_frame_types_of_its_own() -> None:
    beside = HEADER.replace("frame_type", "ping_frame_type")
    assert generator.parse(beside.replace("0x01", "0x02"), generator.parse(HEADER)).types.members == {"FRAME_PING": 2}
    with pytest.raises(generator.HeaderError, match=r"number of protocol\.h"):
        generator.parse(beside, generator.parse(HEADER))


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("int32_t x", "float x", "'float' is not"),
        ("int32_t x;", "int32_t x[3];", "'3' is not PERIOD_MS"),
        ("int32_t x;", "int32_t x[PERIOD_MS]; uint8_t y;", "'uint8_t' is not"),
        ("struct PACKED ping", "struct ping", "'ping' is not PACKED"),
        ("enum { PERIOD_MS = 10 };", "typedef int t;", "'typedef' is not"),
        ("= 10", "", "'}' is not ="),
        ("uint16_t seq; ", "", "does not begin with"),
        ("struct PACKED ping", "struct PACKED pong", "FRAME_PING"),
        ("FRAME_PING = 0x01", "FRAME_PING = 0x01, FRAME_PONG = 2", "FRAME_PONG"),
    ],
)
def test_what_it_does_not_understand_is_named(old: str, new: str, complaint: str) -> None:
    with pytest.raises(generator.HeaderError, match=complaint):
        generator.parse(HEADER.replace(old, new))
