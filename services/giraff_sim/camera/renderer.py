"""A picture of the simulated room as a camera of the robot sees it, in numpy.

All surfaces are met once for each direction in the plane. A pixel then asks from the nearest to the farthest which of
them is as high as it looks. A pixel that meets none before its ray meets the floor shows the floor.
"""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_core.senses import Camera
from giraff_sim.camera.eye import FARTHEST, Eye, View, at, view_from
from giraff_sim.camera.lens import dirt, rays, turned
from giraff_sim.camera.paper import WHITE, board_seen, lay, sheet_seen
from giraff_sim.camera.scene import Scene, Shadow
from giraff_sim.camera.solids import KINDS, WALL, Color, Layer, Layers, Solids, SurfaceHits
from giraff_sim.camera.textures import LEVELS, Floor, Index, Single, Texture, Textures, level_of
from giraff_sim.world.room import Pose

Picture = NDArray[np.uint8]

_AT_ONCE: Final = 8192  # pixels
_BANKS: Final = 3
_SPARE: Final = 16  # pixels by which a field of noise is larger than the picture
_SKIRTING: Final = 0.07  # m
_VIGNETTE: Final = 0.13  # share of the light that is missing at the middle of an edge
_RIM: Final = 1.0 / 0.06  # m, of a shadow
_GREYS: Final = 768
"""Greys of the brightest light: the darker colours are white only beyond 255."""
_HAND: Final = 20.0  # grey level; hardly any light comes through it
_FLOORS: Final[dict[Floor, Color]] = {
    "brick": (84, 108, 152),
    "planks": (78, 118, 166),
    "tiles": (150, 158, 160),
    "carpet": (112, 96, 88),
    "gravel": (118, 126, 130),
    "lino": (136, 158, 150),
    "bare": (136, 158, 150),
}
_CEILING, _FLOOR, _SKIRT, _SKIN = range(len(KINDS), len(KINDS) + 4)
"""Materials beyond the kinds of solids. After them comes paper."""
_TOPS: Final = np.array([kind.top for kind in KINDS], np.float32)
_BOTTOMS: Final = np.array([kind.bottom for kind in KINDS], np.float32)
_IS_WALL: Final = np.array([kind is WALL for kind in KINDS])


class _Pixels(NamedTuple):
    """What each pixel shows."""

    x: Single
    """m, place in the texture."""
    y: Single
    level: Index
    shade: Single
    material: Index


class Renderer:
    """A camera in a room."""

    def __init__(self, camera: Camera, scene: Scene, solids: Solids | None = None, seed: int = 1) -> None:
        """`camera`: as it truly is."""
        self.solids = Solids() if solids is None else solids
        """May be replaced at any time."""
        self._camera, self._scene = camera, scene
        looks: list[tuple[Texture, Color]] = [
            *((kind.texture, kind.color) for kind in KINDS),
            ("plaster", (206, 210, 212)),
            (scene.floor, _FLOORS[scene.floor]),
            ("plaster", (92, 104, 112)),
            ("plaster", (92, 112, 168)),
            ("plaster", (128, 128, 128)),
        ]
        self._textures = Textures(list(dict.fromkeys(texture for texture, _ in looks)), seed)
        self._place = np.array([self._textures.place(texture) for texture, _ in looks], np.intp)
        self._palette = _palette([color for _, color in looks])
        self._tones = (np.array([color for _, color in looks]).mean(axis=1) / 128.0).astype(np.float32)
        self._rays = (turned(camera) @ rays(camera).reshape(-1, 3).T).astype(np.float32)
        self._views: dict[tuple[float, float], View] = {}
        down, across = np.mgrid[-1.0 : 1.0 : camera.height * 1j, -1.0 : 1.0 : camera.width * 1j]
        clear = scene.light * (1.0 - _VIGNETTE * (down**2 + across**2)) * dirt(scene.lens, camera, seed)
        self._clear = clear.astype(np.float32).reshape(-1)
        """Share of the light that comes through the lens."""
        covered = np.arange(camera.width) < scene.lens.covered * camera.width
        self._covered = np.flatnonzero(np.tile(covered, camera.height))
        self._chance = np.random.default_rng(seed)
        shape = (_BANKS, camera.height + _SPARE, camera.width + _SPARE)
        self._noise = self._chance.standard_normal(shape, np.float32) * np.float32(scene.noise)

    def frame(
        self,
        pose: Pose,
        t: float = 0.0,
        *,
        speed: float = 0.0,
        turn: float = 0.0,
        lean: float = 0.0,
        pivot: float = 0.0,
    ) -> Picture:
        """Return the picture: (height, width, 3), blue, green, red.

        `pose` and `t` (s) are of the exposure's middle. `speed` (m/s) and `turn` (rad/s) move the robot meanwhile.
        `lean` (rad) is forward, about an axle that is `pivot` m above the floor.
        """
        camera, exposure = self._camera, self._scene.exposure
        view = self._view(round(lean, 4), pivot)
        blur = exposure * camera.focal_x * (abs(speed) / view.z + abs(turn))
        moments = (-0.25, 0.25) if blur > 1.0 else (0.0,)
        grey, material = np.zeros(1, np.float32), np.zeros(1, np.intp)
        for moment in moments:
            dt = moment * exposure
            yaw = pose.yaw + turn * dt
            moved = Pose(pose.x + speed * dt * math.cos(yaw), pose.y + speed * dt * math.sin(yaw), yaw)
            once, material = self._once(at(view, moved), t + dt)
            grey = grey + once
        grey *= self._clear / np.float32(len(moments))
        if self._scene.switching and t // (self._scene.switching / 2) % 2:
            grey *= np.float32(0.5)
        grey[self._covered], material[self._covered] = _HAND, _SKIN
        right, down = self._chance.integers(0, _SPARE, 2)
        noise = self._noise[self._chance.integers(0, _BANKS)]
        grey += noise[down : down + camera.height, right : right + camera.width].reshape(-1)
        np.minimum(np.maximum(grey, np.float32(0.0), out=grey), np.float32(_GREYS - 1), out=grey)
        shown = grey.astype(np.intp)
        shown += material * _GREYS
        colors = self._palette.take(shown, mode="clip").view(np.uint8)
        return np.ascontiguousarray(colors.reshape(camera.height, camera.width, 4)[:, :, :3])

    def _view(self, lean: float, pivot: float) -> View:
        if (lean, pivot) not in self._views:
            self._views = {(lean, pivot): view_from(self._camera, self._rays, lean, pivot)}
        return self._views[lean, pivot]

    def _once(self, eye: Eye, t: float) -> tuple[Single, Index]:
        """Return the grey at one moment, and the material of each pixel."""
        scene, pixels = self._scene, self._rays.shape[1]
        grey, material = np.empty(pixels, np.float32), np.empty(pixels, np.intp)
        layers = Layers(self.solids.seen(eye.x, eye.y, eye.cosines, eye.sines, scene.people, t))
        for begin in range(0, pixels, _AT_ONCE):
            some = slice(begin, begin + _AT_ONCE)
            grey[some], material[some] = self._drawn(eye.part(some), layers, t)
        shape = self._camera.height, self._camera.width
        if scene.sheet is not None:
            paper = sheet_seen(scene.sheet, *_floor_at(eye, shape)).reshape(-1)
            lay(grey, material, np.where(material == _FLOOR, paper, 0.0), WHITE, self._tones)
        if scene.board is not None:
            covered, painted = board_seen(scene.board, eye, shape)
            lay(grey, material, covered.reshape(-1), painted.reshape(-1), self._tones)
        return grey, material

    def _drawn(self, eye: Eye, layers: Layers, t: float) -> tuple[Single, Index]:
        """Return grey and material of some pixels: so few that all of it stays in the processor's cache."""
        view = eye.view
        x, y = _floor_at(eye, view.floor.shape)
        shade = self._light(x, y)
        if self._scene.shadow is not None:
            shade *= _shadow(self._scene.shadow, x, y, t)
        is_floor = view.floor < FARTHEST
        shade[~is_floor] = 1.0
        level = np.where(is_floor, view.level, LEVELS - 1) + self._place[_FLOOR]
        pixels = _Pixels(x, y, level, shade, np.where(is_floor, _FLOOR, _CEILING))
        left = np.arange(len(x))
        for number in range(len(layers)):
            left = self._meet(eye, layers.seen, layers[number], left, pixels)
            if not len(left):
                break
        grey = self._textures.sample(pixels.x, pixels.y, pixels.level)
        grey *= pixels.shade
        return grey, pixels.material

    def _meet(self, eye: Eye, seen: SurfaceHits, layer: Layer, left: Index, pixels: _Pixels) -> Index:
        """Put in what is met of one layer before the floor. Return the pixels that look on."""
        view, direction = eye.view, eye.view.direction[left]
        away = layer.far.take(direction)
        is_before = away < np.minimum(view.floor[left], np.float32(FARTHEST))
        left, direction, away = left[is_before], direction[is_before], away[is_before]
        which, slope = layer.surface.take(direction), view.slope[left]
        away = seen.exact(which, eye.cos[left], eye.sin[left], away)
        height, kind = np.float32(view.z) + away * slope, seen.kind[which]
        is_met = (height < _TOPS[kind]) & (height >= _BOTTOMS[kind])
        met = np.flatnonzero(is_met)
        pixel, which, kind, slope, direction = left[met], which[met], kind[met], slope[met], direction[met]
        height, away = height[met], away[met]
        is_top = layer.is_far_side.take(direction) & (slope < 0.0)
        away[is_top] = (_TOPS[kind[is_top]] - np.float32(view.z)) / slope[is_top]
        x, y = np.float32(eye.x) + away * eye.cos[pixel], np.float32(eye.y) + away * eye.sin[pixel]
        along = x * seen.along_x[which] + y * seen.along_y[which]
        pixels.x[pixel] = np.where(is_top, x, along)
        pixels.y[pixel] = np.where(is_top, y, height)
        pixels.level[pixel] = level_of(away * view.stretch[pixel]) + self._place[kind]
        pixels.shade[pixel] = layer.shade.take(direction) * self._light(x, y)
        pixels.material[pixel] = np.where(_IS_WALL[kind] & (height < _SKIRTING), _SKIRT, kind)
        return left[~is_met]

    def _light(self, x: Single, y: Single) -> Single:
        toward = 0.4 * x + 0.25 * y - 2.0
        light = 1.0 - self._scene.gradient * toward / (1.0 + np.abs(toward))
        return light.astype(np.float32, copy=False)


def _floor_at(eye: Eye, shape: tuple[int, ...]) -> tuple[Single, Single]:
    """Return where on the floor each pixel looks."""
    far = np.minimum(eye.view.floor, np.float32(FARTHEST))
    x, y = np.float32(eye.x) + far * eye.cos, np.float32(eye.y) + far * eye.sin
    return x.reshape(shape), y.reshape(shape)


def _shadow(shadow: Shadow, x: Single, y: Single, t: float) -> Single:
    """Return the share of the light at these places."""
    offset = shadow.middle + shadow.swing * math.sin(math.tau * t / shadow.period)
    cos, sin = np.float32(math.cos(shadow.toward)), np.float32(math.sin(shadow.toward))
    inside = np.float32(shadow.half_width) - np.abs(x * cos + y * sin - np.float32(offset))
    light = np.float32(1.0) - inside * np.float32(_RIM)
    left: Single = np.minimum(np.maximum(light, np.float32(shadow.light)), np.float32(1.0))
    return left


def _palette(colors: list[Color]) -> NDArray[np.uint32]:
    """Return blue, green and red of each material at each grey."""
    table = np.zeros((len(colors), _GREYS, 4), np.uint8)
    shares = np.array(colors)[:, None, :] / 128.0
    table[:, :, :3] = np.clip(np.rint(np.arange(_GREYS)[None, :, None] * shares), 0, 255)
    return table.reshape(-1).view(np.uint32)
