"""Expected readings of ultrasonic sensors on a floor plan, and how likely each reading is."""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_core.robot import RobotConfig
from giraff_core.senses import HC_SR04, LaserScanner, Ultrasonic
from giraff_localization.beams.range_table import CLEAR, SLANTED, SOLID, Cone, RangeTable
from giraff_localization.config import LocalizationConfig
from giraff_localization.free_space import FreeSpace
from giraff_maps.floor_plan import FloorPlan

_HIT: Final = 0.72
_NEARER: Final = 0.10
_WILD: Final = 0.10
_LOST: Final = 0.08
_SPREAD: Final = 0.15
"""m, standard deviation of an echo: of the map and of furniture, far more than the sensor's own."""
_SURPRISE: Final = 0.15
"""Share of echoes where nothing is on the map."""
_SLANTED_CLEAR: Final = 0.45
"""Share of no echo from what is too slanted."""
_SOLID: Final = 0.02
"""Likelihood of each reading of a sensor that would be within a wall."""
_NEAR: Final = 0.3
"""m: an echo of something nearer than a wall is taken to come from so much of room at least."""


class Beam(NamedTuple):
    """One reading, of a sensor at that place on the robot as it is now."""

    x: float
    y: float
    yaw: float
    reading: int
    """In bins, or CLEAR."""
    share: float
    """Part of one, by which it counts: readings of one sensor on one way say nearly the same."""
    kind: int = 0
    """Number of its model in `Sonars.models`."""


class SonarModel:
    """Expected readings of one kind of sensor. Of no use until the table is built."""

    def __init__(self, plan: FloorPlan, space: FreeSpace, cone: Cone) -> None:
        self.reach = cone.reach
        self.table = RangeTable(plan, space, cone)
        self.likely: npt.NDArray[np.float32] = beam_model(cone.reach, self.table.bin)
        """As `beam_model` makes it."""


class Sonars:
    """The ultrasonic sensors of a robot on a floor plan: those that are alike share one model. A robot that is found by
    its scanner needs none."""

    def __init__(self, plan: FloorPlan, space: FreeSpace, config: LocalizationConfig, robot: RobotConfig) -> None:
        sensors = {} if robot.of(LaserScanner) else robot.of(Ultrasonic) or {"": HC_SR04}
        cones = {name: _cone(config, each) for name, each in sensors.items()}
        kinds = list(dict.fromkeys(cones.values()))
        self.models = tuple(SonarModel(plan, space, cone) for cone in kinds)
        self.kinds = {name: kinds.index(cone) for name, cone in cones.items()}
        """Number of the model of each sensor."""

    def build(self) -> Iterator[float]:
        """Compute the tables bit by bit; tells the share that is done after each."""
        for number, model in enumerate(self.models):
            for share in model.table.build():
                yield (number + share) / len(self.models)

    def alike(self, beams: Sequence[Beam]) -> Iterator[tuple[SonarModel, list[Beam]]]:
        """Yield each model with the beams that are of it."""
        for kind, model in enumerate(self.models):
            if alike := [beam for beam in beams if beam.kind == kind]:
                yield model, alike


def beam_model(reach: float, bin_size: float) -> npt.NDArray[np.float32]:
    """log p(reading | expected), by reading (a range in bins, or CLEAR) and by expected; of echoes: per m.

    A mixture as in S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), section 6.3: the expected echo, one of
    something nearer that is not on the map, one of no meaning, and none at all. Where no echo is expected, that there
    is none is a reading of its own, with its own likelihood. `reach`, `bin_size`: m.
    """
    bins = np.arange(CLEAR) * bin_size
    likely = np.full((SOLID + 1, SOLID + 1), _SOLID / reach)
    echo, none = slice(0, CLEAR), CLEAR
    off = (bins[:, None] - bins[None, :]) / _SPREAD
    nearer = (bins[:, None] < bins[None, :]) / np.maximum(bins[None, :], _NEAR)
    hit = np.exp(-0.5 * off * off) / (_SPREAD * np.sqrt(2.0 * np.pi))
    likely[echo, echo] = _HIT * hit + _NEARER * nearer + _WILD / reach
    likely[none, echo] = _LOST
    likely[echo, CLEAR], likely[none, CLEAR] = _SURPRISE / reach, 1.0 - _SURPRISE
    likely[echo, SLANTED], likely[none, SLANTED] = (1.0 - _SLANTED_CLEAR) / reach, _SLANTED_CLEAR
    likely[none, SOLID] = _SOLID
    model: npt.NDArray[np.float32] = np.log(likely).astype(np.float32)
    return model


def _cone(config: LocalizationConfig, sensor: Ultrasonic) -> Cone:
    return Cone(
        config.reach or sensor.reach, config.half_cone or sensor.half_cone, config.incidence or sensor.incidence
    )
