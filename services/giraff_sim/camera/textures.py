"""Floors and other materials as grey pictures that wrap around, made of noise. No file is read."""

import math
import random
from collections.abc import Sequence
from functools import lru_cache
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.float64]
Index = NDArray[np.intp]
Single = NDArray[np.float32]

Floor = Literal["brick", "planks", "tiles", "carpet", "gravel", "lino", "bare"]
Cover = Literal["plaster", "wood", "cloth"]
"""Textures of walls and furniture."""
Texture = Literal[Floor, Cover]
FLOORS: Final[tuple[Floor, ...]] = get_args(Floor)

SIZE: Final = 512
TEXEL: Final = 0.004
"""m. A texture repeats after 2.05 m."""
LEVELS: Final = 15
"""Each is softer than the one before by half an octave; the last one is even."""


def _noise(chance: "np.random.Generator", sigma: float) -> Grey:
    """Return smooth noise of mean 0 and deviation 1 that wraps around; `sigma`: texels."""
    return _scaled(_softened(chance.standard_normal((SIZE, SIZE)), sigma))


def _scaled(values: Grey) -> Grey:
    spread: Grey = (values - values.mean()) / values.std()
    return spread


def _softened(values: Grey, sigma: float, upright: float | None = None) -> Grey:
    """Blur by so many texels; `upright`: along the columns, where it differs."""
    soft: Grey = np.fft.irfft2(np.fft.rfft2(values) * _low(sigma, sigma if upright is None else upright), (SIZE, SIZE))
    return soft


def _low(sigma: float, upright: float) -> Grey:
    rows, columns = np.fft.fftfreq(SIZE)[:, None] * upright, np.fft.rfftfreq(SIZE)[None, :] * sigma
    low: Grey = np.exp(-2.0 * math.pi**2 * rows**2) * np.exp(-2.0 * math.pi**2 * columns**2)
    return low


@lru_cache(maxsize=len(get_args(Floor)) + len(get_args(Cover)))
def _levels(name: Texture, seed: int) -> NDArray[np.uint8]:
    """Return one material at all softnesses, one after the other."""
    grey = _grey(name, np.random.default_rng(random.Random(f"{seed}/{name}").getrandbits(64)))
    spectrum = np.fft.rfft2((grey + 128 - grey.mean()).astype(np.float32))
    levels = np.full((LEVELS, SIZE, SIZE), 128, np.uint8)
    for level in range(LEVELS - 1):
        sigma = 0.45 * 2.0 ** (level / 2)
        soft = np.fft.irfft2(spectrum * _low(sigma, sigma).astype(np.float32), (SIZE, SIZE))
        levels[level] = np.clip(np.rint(soft), 0, 255)
    return levels.reshape(-1)


def _grey(name: Texture, chance: "np.random.Generator") -> Grey:
    """Return one material; 128 is its usual brightness."""
    x = np.arange(SIZE)[None, :]
    match name:
        case "plaster":
            return 128 + 2.5 * _noise(chance, 1.2) + 2.0 * _noise(chance, 8) + 2.5 * _noise(chance, 40)
        case "wood":  # its grain is upright
            grain = _scaled(_softened(chance.standard_normal((SIZE, SIZE)), 1.0, 24.0))
            return 128 + 8 * grain + 4 * _noise(chance, 20) - 35 * (x % 128 < 2)
        case "cloth":
            return 128 + 8 * _noise(chance, 0.8) + 6 * _noise(chance, 3) + 6 * _noise(chance, 12)
        case _:
            return _floor(name, chance)


def _floor(name: Floor, chance: "np.random.Generator") -> Grey:
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    match name:
        case "brick":  # 0.256 by 0.128 m, each row half a brick on
            row, along = y // 32, x + 32 * (y // 32 % 2)
            shade: Grey = chance.uniform(-22, 22, (16, 8))[row, along // 64 % 8]
            joint = (along % 64 < 3) | (y % 32 < 3)
            return np.where(joint, 80.0, 132 + shade) + 7 * _noise(chance, 1.2) + 5 * _noise(chance, 6)
        case "planks":  # 0.128 m wide
            row = y // 32
            shade = chance.uniform(-16, 16, SIZE // 32)[row]
            grain = _scaled(_softened(chance.standard_normal((SIZE, SIZE)), 12.0, 0.8))
            joint = ((x + row * 197) % 300 < 2) | (y % 32 == 0)
            return np.where(joint, 85.0, 130 + shade) + 7 * grain + 3 * _noise(chance, 1.5)
        case "tiles":  # 0.256 m
            shade = chance.uniform(-6, 6, (8, 8))[y // 64, x // 64]
            joint = (x % 64 < 2) | (y % 64 < 2)
            return np.where(joint, 85.0, 130 + shade) + 2.5 * _noise(chance, 1.5) + 3 * _noise(chance, 8)
        case "carpet":
            return 128 + 14 * _noise(chance, 1.0) + 10 * _noise(chance, 4) + 8 * _noise(chance, 20)
        case "gravel":
            return _stones(chance)
        case "lino":
            return 128 + 2.0 * _noise(chance, 1.0) + 1.5 * _noise(chance, 6)
        case "bare":
            return np.full((SIZE, SIZE), 128.0)


def _stones(chance: "np.random.Generator", cell: int = 8) -> Grey:
    """Return pebbles of about 3 cm: one in each square cell, out of its middle."""
    cells = SIZE // cell
    shift_x, shift_y = chance.uniform(0.0, cell, (2, cells, cells))
    shade: Grey = chance.uniform(-38, 38, (cells, cells))
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    nearest, second = np.full((SIZE, SIZE), np.inf), np.full((SIZE, SIZE), np.inf)
    grey = np.zeros((SIZE, SIZE))
    for across in (-1, 0, 1):
        for down in (-1, 0, 1):
            column, row = x // cell + across, y // cell + down
            at = row % cells, column % cells
            far = np.hypot(column * cell + shift_x[at] - x, row * cell + shift_y[at] - y)
            grey = np.where(far < nearest, shade[at], grey)
            second = np.minimum(second, np.maximum(far, nearest))
            nearest = np.minimum(nearest, far)
    gap: Grey = np.clip((second - nearest) / 2.5, 0.0, 1.0)
    return 45 + (90 + grey) * gap + 6 * _noise(chance, 1.0)


@lru_cache(maxsize=len(get_args(Floor)))
def _joined(names: tuple[Texture, ...], seed: int) -> NDArray[np.uint8]:
    return np.concatenate([_levels(name, seed) for name in names])


class Textures:
    """Some materials at all softnesses, for one look-up."""

    def __init__(self, names: Sequence[Texture], seed: int) -> None:
        self._place = {name: number for number, name in enumerate(names)}
        self._flat = _joined(tuple(names), seed)

    def place(self, name: Texture) -> int:
        """Return where a material begins, to be added to its level."""
        return self._place[name] * LEVELS

    def sample(self, x: Single, y: Single, level: Index) -> Single:
        """Return the grey at these places (m) between four texels; `level`: with the material's place added."""
        across, down = x * np.float32(1.0 / TEXEL), y * np.float32(1.0 / TEXEL)
        left, top = np.floor(across), np.floor(down)
        across -= left
        down -= top
        column, row = left.astype(np.intp), top.astype(np.intp)
        begin = level * (SIZE * SIZE)
        upper = begin + ((row & (SIZE - 1)) * SIZE)
        lower = begin + (((row + 1) & (SIZE - 1)) * SIZE)
        right = (column + 1) & (SIZE - 1)
        column &= SIZE - 1

        def between(line: Index) -> Single:
            one: Single = self._flat.take(line + column, mode="clip").astype(np.float32)
            other = self._flat.take(line + right, mode="clip").astype(np.float32)
            other -= one
            other *= across
            one += other
            return one

        value, below = between(upper), between(lower)
        below -= value
        below *= down
        value += below
        return value


def level_of(footprint: Single) -> Index:
    """Return the softness for pixels that cover so many m."""
    level = np.rint(np.log2(np.maximum(footprint * np.float32(1.0 / TEXEL), np.float32(1.0))) * np.float32(2.0))
    softness: Index = np.minimum(level, np.float32(LEVELS - 1)).astype(np.intp)
    return softness
