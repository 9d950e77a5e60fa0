"""An occupancy grid as ROS's map_server and nav2_map_server keep it: a YAML file, and an image that it names.

    image: flat.pgm                # beside the YAML file, an absolute path, or one from ~; PGM, PNG or BMP
    resolution: 0.05               # m, side of a cell
    origin: [-2.0, -1.5, 0.0]      # m, m, rad: the lower left corner of the image in the map
    negate: 0                      # 1: white is occupied
    occupied_thresh: 0.65          # what is darker is occupied
    free_thresh: 0.196             # what is lighter is free; all between is unknown
    mode: trinary                  # in any case; or scale; raw: a pixel is its occupancy in percent, over 100 unknown

A pixel that is not opaque is unknown in every mode. (map_server reckons its opacity into a colour in one of the three,
by which transparent black is a wall.)
"""

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import msgspec

from giraff_core.kinematics.parts import ANGLE
from giraff_maps.floor_plan import LARGEST, MapError, at_home, read_text, require_file
from giraff_node.process.libraries import remedy
from giraff_schemas.text import near, plain

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from PIL import Image

    Occupied = NDArray[np.bool_]

MOST_CELLS: Final = 25_000_000
_FORMATS: Final = ("PPM", "PNG", "BMP")
_DEEP: Final = 65535 / 255  # of a pixel of 16 bits to one of 8
_OPAQUE: Final = 255


class GridFile(msgspec.Struct, frozen=True, kw_only=True):
    """What the YAML file says."""

    image: str
    resolution: float
    """m"""
    origin: tuple[float, float, float]
    """m, m, rad"""
    negate: bool | int = 0
    occupied_thresh: float = 0.65
    """0..1"""
    free_thresh: float = 0.196
    """0..1"""
    mode: Literal["trinary", "scale", "raw"] = "trinary"


class Grid(NamedTuple):
    """Where something stands, in cells: the first row is the lowest, the first column the leftmost."""

    occupied: "Occupied"
    resolution: float
    """m"""
    origin: tuple[float, float, float]
    """m, m, rad; of the lower left corner of the first cell."""


def read_grid(path: Path) -> Grid:
    """The grid of a YAML file and its image. Raises MapError, also where a library is missing."""
    said = _read_yaml(path)
    _require_sense(path, said)
    image_path = path.parent / at_home(Path(said.image))
    image = _open_image(path, image_path, said.resolution)
    return Grid(_occupied(path, said, image)[::-1], said.resolution, said.origin)


def _read_yaml(path: Path) -> GridFile:
    try:
        import yaml  # noqa: PLC0415
    except ImportError as error:
        raise _missing(path, "yaml") from error
    try:
        content = yaml.safe_load(read_text(path))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise MapError(f"{path}: not YAML: {plain(error)}") from error
    if isinstance(content, dict):
        _require_known(path, content)
        if isinstance(mode := content.get("mode"), str):
            content["mode"] = mode.lower()
    try:
        return msgspec.convert(content, GridFile, strict=False)
    except ValueError as error:
        told = plain(error)
        raise MapError(f"{path}: no grid of map_server: {told}{_form(told, content)}") from error


def _form(told: str, content: Any) -> str:
    """Return how a mode or a resolution is written, where `told` says that it cannot be read."""
    if told.startswith("resolution ") and isinstance(text := content["resolution"], str):
        return f" ({text[:20]!r}); write it like 0.05"
    return "; known are: trinary, scale, raw" if told.startswith("mode ") else ""


def _require_known(path: Path, content: dict[Any, Any]) -> None:
    """What others have added is left alone; what is nearly the name of a field is a slip."""
    fields = [name for name in GridFile.__struct_fields__ if name not in content]
    for key in content:
        if key not in GridFile.__struct_fields__ and (meant := near(str(key), fields)):
            raise MapError(f"{path}: unknown field `{key}`; did you mean '{meant[0]}'?")


def _require_sense(path: Path, said: GridFile) -> None:
    if not all(map(math.isfinite, said.origin)):
        raise MapError(f"{path}: origin must be three finite numbers: m, m and rad")
    try:
        ANGLE.require("the yaw in origin", said.origin[2])
    except ValueError as error:
        raise MapError(f"{path}: {error}") from error
    if not (math.isfinite(said.resolution) and said.resolution > 0.0):
        raise MapError(f"{path}: resolution {said.resolution:g} must be the side of a cell in metres, most often 0.05")
    if not 0.0 <= said.free_thresh <= said.occupied_thresh <= 1.0:
        raise MapError(
            f"{path}: free_thresh {said.free_thresh:g} and occupied_thresh {said.occupied_thresh:g} must be in this"
            " order and from 0 to 1, such as 0.196 and 0.65"
        )
    if said.negate not in (0, 1):
        raise MapError(f"{path}: negate {said.negate} must be 0 or 1")


def _open_image(path: Path, image_path: Path, resolution: float) -> "Image.Image":
    """Its pixels are read, and are not too many."""
    try:
        from PIL import Image, UnidentifiedImageError  # noqa: PLC0415
    except ImportError as error:
        raise _missing(path, "pillow") from error
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            require_file(image_path)
            image = Image.open(image_path, formats=_FORMATS)
            with image:
                _require_size(path, image.size, resolution)
                image.load()
    except FileNotFoundError as error:
        raise MapError(f"{path}: its image {image_path} is not there: both files belong together") from error
    except UnidentifiedImageError as error:
        raise MapError(f"{image_path}: no image of the kinds PGM, PNG and BMP") from error
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise MapError(f"{image_path}: far too many pixels: crop it, or use a coarser resolution") from error
    except (OSError, SyntaxError, ValueError, EOFError) as error:
        why = getattr(error, "strerror", None) or error
        raise MapError(f"{image_path}: cannot be read, perhaps it is torn: {why}") from error
    return image


def _require_size(path: Path, size: tuple[int, int], resolution: float) -> None:
    """Before its pixels are read: by its cells and by its metres."""
    width, height = size
    if max(width, height) * resolution > LARGEST and resolution > 0.5:
        raise MapError(
            f"{path}: {width * resolution:g} x {height * resolution:g} m is too large:"
            " resolution is the side of a cell in metres, most often 0.05"
        )
    if width * height > MOST_CELLS:
        raise MapError(
            f"{path}: an image of {width} x {height} pixels is too large: crop it, or use a coarser resolution"
        )


def _occupied(path: Path, said: GridFile, image: "Image.Image") -> "Occupied":
    """Which pixels are occupied; the first row is the topmost."""
    try:
        import numpy as np  # noqa: PLC0415
    except ImportError as error:
        raise _missing(path, "numpy") from error
    if image.mode.startswith(("I", "F")):
        shade = np.asarray(image).astype(np.float32) / _DEEP
        opaque = np.ones(shade.shape, dtype=np.bool_)
    else:
        pixels = np.asarray(image.convert("RGBA"))
        shade = pixels[..., :3].mean(axis=-1, dtype=np.float32)
        opaque = pixels[..., 3] == _OPAQUE
    if said.mode == "raw":
        share = np.rint(shade) / 100.0
        known = opaque & (share <= 1.0)
        occupied = share >= said.occupied_thresh
    else:
        share = (shade if said.negate else 255.0 - shade) / 255.0
        known = opaque
        occupied = share > said.occupied_thresh
    return np.asarray(known & occupied, dtype=np.bool_)


def _missing(path: Path, library: str) -> MapError:
    return MapError(f"{path}: to read it, the library {library} is missing; {remedy('localization')}")
