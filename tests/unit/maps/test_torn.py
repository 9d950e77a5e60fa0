"""Files that were hurt on their way: they are read or refused in a line, and nothing else happens."""

import random
from contextlib import suppress
from pathlib import Path

import pytest
from PIL import Image

from giraff_maps.floor_plan import MapError
from giraff_maps.read import read_map
from tests.unit.maps.grids import LIVING_ROOM, YAML, written

_INSERTED = b"0123456789.-[]{}:eE\n\x00\xff"
_TRIES = 60


def hurt(whole: bytes, chance: random.Random) -> bytes:
    """Some bytes changed, lost or put in, often near the beginning; or torn off."""
    content = bytearray(whole)
    for _ in range(chance.choice((1, 1, 2, 5))):
        at = chance.randrange(len(content)) if chance.random() < 0.5 else chance.randrange(min(60, len(content)))
        match chance.randrange(4):
            case 0:
                content[at] = chance.randrange(256)
            case 1:
                del content[at + 1 : at + chance.randrange(2, 10)]
            case 2:
                content[at:at] = bytes(chance.choices(_INSERTED, k=4))
            case _:
                del content[at + 1 :]
    return bytes(content)


def _use(path: Path) -> None:
    said = "read"
    try:
        read_map(path)
    except MapError as error:
        said = str(error)
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGBA"])
def test_an_image(tmp_path: Path, mode: str) -> None:
    image = Image.new("L", (30, 30), 254)
    image.paste(0, (3, 3, 20, 6))
    chance = random.Random(mode)
    for kind in ("png", "bmp", "pgm"):
        path = written(tmp_path, YAML.replace("map.pgm", f"map.{kind}"))
        with suppress(OSError):  # not every kind has every mode
            image.convert(mode).save(tmp_path / f"map.{kind}")
            whole = (tmp_path / f"map.{kind}").read_bytes()
            for _ in range(_TRIES):
                (tmp_path / f"map.{kind}").write_bytes(hurt(whole, chance))
                _use(path)


def test_a_yaml_file(tmp_path: Path) -> None:
    image = Image.new("L", (30, 30), 254)
    image.paste(0, (3, 3, 20, 6))
    image.save(tmp_path / "map.pgm")
    chance = random.Random("yaml")
    for _ in range(3 * _TRIES):
        (tmp_path / "map.yaml").write_bytes(hurt(YAML.encode(), chance))
        _use(tmp_path / "map.yaml")


def test_a_room_file(tmp_path: Path) -> None:
    whole, chance = LIVING_ROOM.read_bytes(), random.Random("room")
    for _ in range(3 * _TRIES):
        (tmp_path / "room.toml").write_bytes(hurt(whole, chance))
        _use(tmp_path / "room.toml")
