"""Whether it is known where the robot is.

`localized` takes all of these, on some metres: one narrow cluster with nearly all particles; readings that it explains;
no restart cloud ahead; a restart cloud that began anywhere and came to the same place, unless somebody told it; no
equivalent place left. A place that somebody has told is `told` until then, for some metres, and while nothing
contradicts it.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_localization.clusters import Cluster, are_near
from giraff_localization.track import Stride
from giraff_schemas.localization import Candidate, LocalizationState
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_MASS: Final = 0.95
_SPREAD: Final = 0.35
_FIT: Final = 0.70
"""Share of the particles, m of their standard deviation, share of the readings that the place explains."""
_HELD: Final = 3.0
_HELD_TOLD: Final = 2.0
"""m on which all of it must hold; less where somebody has told where it is."""
_AGREES: Final = 0.9
_BEHIND: Final = -0.5
"""Nats that a restart cloud may be ahead."""

_KEEP_MASS: Final = 0.8
_KEEP_SPREAD: Final = 0.6
_KEEP_FIT: Final = 0.45
_KEEP_BEHIND: Final = -1.0
"""Below these, what was known is not any more."""

_CANDIDATE_MASS: Final = 0.1
_CANDIDATE_SPREAD: Final = 0.6
_CANDIDATE_FIT: Final = 0.55
_TOGETHER: Final = 0.7
"""Mass that the candidates must have to be all that there is."""

UNJUDGED: Final = 0.5
"""m after somebody has told the place, on which too little was heard to contradict it."""
TOLD_HOLDS: Final = 5.0
"""m after which a place that was told, and that nothing has confirmed, is not driven by any more."""
_TOLD_SPREAD: Final = 0.75
"""m; as `_KEEP_SPREAD`, of a place that somebody has told."""

_WRONG_MAP: Final = 40.0
"""m that it is not known where the robot is, after which the map is doubted, unless some place explains what is
heard."""
_LONG: Final = 20.0
"""m, over which that is asked."""
_EXPLAINS: Final = 0.75
_BELIEVABLE: Final = 0.60
"""Shares of the readings over these metres: below them the map is doubted, and no place is believed on it."""
UNHEARD: Final = 3.0
"""m without a reading that says anything, after which nothing is known any more."""

LOOKS: Final = Trouble("not found yet", "drive on, along walls and round corners, and turn now and then")
CHECKS: Final = Trouble("it was told where it is, and that is checked", "drive on two metres or three")
UNCONFIRMED: Final = Trouble(
    "the sensors have not confirmed the place that was told",
    "drive on; if that does not help",
    "run",
    "giraff localize --at X,Y,YAW",
)
DOUBTS: Final = Trouble(
    "what the sensors hear fits this place no more: carried away, or things stand about", "drive on"
)
_HEARS_NOTHING: Final = Trouble(
    "no sensor has told anything for some metres",
    "check that giraff_ranger runs, and the sensors of the robot file, or drive to where walls are within 4 m",
)


def several_fit(count: int) -> Trouble:
    """Return the trouble of so many places."""
    return Trouble(f"{count} places fit", "drive to where they differ")


class Fits(NamedTuple):
    """Shares of the readings that the best place explains, 0..1."""

    long: float
    """Of the last metres."""
    recent: float
    """Of the last metre or two."""
    unheard: float = 0.0
    """m since any reading said anything."""


class Judgement:
    """Of one search."""

    def __init__(self, *, was_told: bool) -> None:
        self.state: LocalizationState = "told" if was_told else "lost"
        self.way = 0.0
        """m since it was last known where it is, or since the search began."""
        self.candidates: list[Candidate] = []
        """While it is not known, best first."""
        self.others: list[Pose] = []
        """Of the candidates, those that particles have, but for the best."""
        self._held = 0.0
        self._agreed = self._was_told = was_told
        self._was_known = False
        self._long_fit = 1.0
        """What the best place explained of the last `_LONG` m, whichever it was."""
        self._is_deaf = False
        self._told_left = TOLD_HOLDS if was_told else 0.0
        """m on which the place that was told may still be driven by. 0: it was contradicted, or there was none."""

    def begin_anew(self) -> None:
        """Another cloud has taken over."""
        self._leave()
        self._agreed = self._was_told = False

    def judge(
        self,
        found: Sequence[Cluster],
        rivals: Sequence[Cluster],
        fits: Fits,
        lead: float,
        equivalents: Sequence[Pose],
        stride: Stride,
    ) -> None:
        """After an update. `rivals`: of a restart cloud that has settled."""
        best = found[0] if found else None
        self._long_fit += (fits.long - self._long_fit) * (1.0 - math.exp(-stride.effort / _LONG))
        self._is_deaf = fits.unheard > UNHEARD
        explains = fits.long >= _FIT and self._long_fit >= _BELIEVABLE and _is_heard(fits)
        good = best is not None and best.mass >= _MASS and best.spread <= _SPREAD and explains and lead > _BEHIND
        self._held = self._held + stride.effort if good else 0.0
        agree = 0.0 if best is None else sum(each.mass for each in rivals if each.is_near(best.pose))
        self._agreed = (good and (self._agreed or agree > _AGREES)) or (self._was_told and self._agreed)
        self._told_left = max(0.0, self._told_left - stride.effort)
        if self.state == "localized":
            if not _holds(best, _KEEP_SPREAD, lead) or not _is_heard(fits):
                self._leave()
        elif self._held > (_HELD_TOLD if self._was_told else _HELD) and self._agreed and not equivalents:
            self.state, self._was_known = "localized", True
        if self.state == "localized":
            self.way, self.candidates, self.others = 0.0, [], []
            return
        self.way += stride.way
        self._list(found, rivals, equivalents, fits)
        is_heard = _is_heard(fits) or self._told_left > TOLD_HOLDS - UNJUDGED
        if self.state == "ambiguous" or not _holds(best, _TOLD_SPREAD, lead) or not is_heard:
            self._told_left = 0.0
        if self._told_left:
            self.state = "told"

    @property
    def reason(self) -> Trouble:
        """Why it is not known."""
        if self.state == "localized":
            return NO_TROUBLE
        if self._is_deaf:
            return _HEARS_NOTHING
        if self.way > _WRONG_MAP and self._long_fit < _EXPLAINS:
            driven = f"driven {self.way:.0f} m, and no place fits well: this may not be the map"
            return Trouble(driven, "check it, and its scale")
        if self.state == "ambiguous":
            return several_fit(len(self.candidates))
        if self._was_told:
            return CHECKS if self.state == "told" else UNCONFIRMED
        return DOUBTS if self._was_known else LOOKS

    def _leave(self) -> None:
        self.state, self._held = "lost", 0.0
        self._was_told = self._agreed = False
        self._told_left = 0.0

    def _list(
        self, found: Sequence[Cluster], rivals: Sequence[Cluster], equivalents: Sequence[Pose], fits: Fits
    ) -> None:
        places = [(each.pose, each.mass) for each in found if _is_candidate(each)]
        together = sum(mass for _, mass in places)
        for rival in rivals:
            if _is_candidate(rival) and _is_new(rival.pose, places):
                places.append((rival.pose, rival.mass))
        self.others = [pose for pose, _ in places if found and not found[0].is_near(pose)]
        for equivalent in equivalents:
            if _is_new(equivalent, places):
                places.append((equivalent, 0.0))
        self.candidates = [Candidate(x=pose.x, y=pose.y, yaw=pose.yaw, belief=mass) for pose, mass in places]
        is_all = fits.long >= _CANDIDATE_FIT and fits.unheard <= UNHEARD and together > _TOGETHER
        self.state = "ambiguous" if is_all and len(places) > 1 else "lost"


def _holds(best: Cluster | None, spread: float, lead: float) -> bool:
    """Tell whether nearly all particles are in one place, and no restart cloud is ahead."""
    return best is not None and best.mass >= _KEEP_MASS and best.spread <= spread and lead >= _KEEP_BEHIND


def _is_heard(fits: Fits) -> bool:
    """Whether the sensors still say that it is there."""
    return fits.recent >= _KEEP_FIT and fits.unheard <= UNHEARD


def _is_candidate(cluster: Cluster) -> bool:
    return cluster.mass >= _CANDIDATE_MASS and cluster.spread < _CANDIDATE_SPREAD


def _is_new(pose: Pose, places: Sequence[tuple[Pose, float]]) -> bool:
    return not any(are_near(pose, place) for place, _ in places)
