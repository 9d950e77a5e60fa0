"""The tree of a robot's frames, and where any of them is in any other, now or a moment ago.

`lookup(target, source)` has the order of tf2's `lookup_transform`: the pose of `source`, in `target`.
"""

from collections.abc import Iterable
from typing import Final

from giraff_core.kinematics.pose_history import GapError, PoseHistory, UnconnectedError, UnknownFrameError
from giraff_core.kinematics.rigid import HERE, Rigid, rigid
from giraff_schemas.frames import BASE_FRAME, MAP_FRAME, ODOM_FRAME, Transform
from giraff_schemas.messages import Odometry, RobotTime

_OTHERS: Final = "ranger tells of the sensors', odometry of all others: check the name, and that they run"
_MAP: Final = (
    "localization tells of the map, and only while it is known where the robot is: check that giraff_localization "
    "runs, and what it says"
)


class FrameTree:
    """What was told of frames. Where `base_link` is in `odom`, odometry says; of all others the newest word counts."""

    def __init__(self, told: Iterable[Transform] = ()) -> None:
        self._told = {transform.child: transform for transform in told}
        self._history = PoseHistory()

    def on_transform(self, transform: Transform) -> None:
        """Take where a frame is."""
        self._told[transform.child] = transform

    def forget(self, child: str) -> None:
        """Of a frame that is told of: nobody knows any more where it is."""
        self._told.pop(child, None)

    def on_odometry(self, odometry: Odometry) -> None:
        """Take where the robot is, as it arrives."""
        self._history.on_odometry(odometry)

    @property
    def frames(self) -> list[str]:
        """All that are known, by name."""
        edges = list(self._told.values())
        moved = () if self._history.newest() is None else (BASE_FRAME, ODOM_FRAME)
        return sorted({*moved, *(edge.child for edge in edges), *(edge.parent for edge in edges)})

    def lookup(self, target: str, source: str, at: RobotTime | None = None) -> Transform:
        """The pose of `source` in `target` at that moment; None: the newest.

        Raises UnknownFrameError, UnconnectedError, and, unless all between them is fixed, what `PoseHistory.at` raises.
        """
        known = self.frames
        for frame in (target, source):
            if frame not in known:
                others = ", ".join(known) or "none"
                teller = _MAP if frame == MAP_FRAME else _OTHERS
                raise UnknownFrameError(f"no frame is called {frame!r}, those that are known: {others}; {teller}")
        above_target, above_source = self._up(target), self._up(source)
        common = next((frame for frame in above_source if frame in above_target), None)
        if common is None:
            raise UnconnectedError(
                f"{target} and {source} do not hang together: the one is in {above_target[-1]}, the other in "
                f"{above_source[-1]}, and nobody tells where they are in each other; `giraff frames` shows it"
            )
        down, up = above_target[: above_target.index(common)], above_source[: above_source.index(common)]
        found = self._composed(down, at).inverse.then(self._composed(up, at))
        moving = [edge for edge in map(self._edge, (*down, *up)) if not edge.fixed]
        roll, pitch, yaw, x, y, z = (number + 0.0 for number in (*found.angles, *found.translation))  # no -0.0
        return Transform(
            parent=target,
            child=source,
            x=x,
            y=y,
            z=z,
            roll=roll,
            pitch=pitch,
            yaw=yaw,
            fixed=not moving,
            tick=(at or moving[0].tick) if moving else None,
        )

    def _up(self, frame: str) -> list[str]:
        """It, what it is in, what that is in."""
        chain = [frame]
        while (above := self._parent(chain[-1])) is not None and above not in chain:
            chain.append(above)
        return chain

    def _parent(self, frame: str) -> str | None:
        if frame == BASE_FRAME and self._history.newest() is not None:
            return ODOM_FRAME
        return self._told[frame].parent if frame in self._told else None

    def _composed(self, chain: Iterable[str], at: RobotTime | None) -> Rigid:
        """Where the first of these, each of which is in the next, is in what the last is in."""
        pose = HERE
        for frame in chain:
            edge = self._edge(frame, at)
            pose = rigid(edge.x, edge.y, edge.z, edge.roll, edge.pitch, edge.yaw).then(pose)
        return pose

    def _edge(self, frame: str, at: RobotTime | None = None) -> Transform:
        newest = self._history.newest() if frame == BASE_FRAME else None
        if newest is None:
            told = self._told[frame]
            # Where odom is in the map is how odometry's error of the whole way is corrected, not where anything went:
            # the newest word is the best one of any moment.
            if at is not None and not told.fixed and told.tick != at and frame != ODOM_FRAME:
                raise GapError(f"where {frame} is in {told.parent} is known of one moment only, and not of that one")
            return told
        pose = newest[0] if at is None else self._history.at(at)
        tick = at or newest[1]
        return Transform(parent=ODOM_FRAME, child=BASE_FRAME, x=pose.x, y=pose.y, yaw=pose.yaw, fixed=False, tick=tick)
