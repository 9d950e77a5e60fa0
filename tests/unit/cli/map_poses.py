"""What localization says, as it would say it."""

from giraff_core.kinematics.pose import Pose
from giraff_schemas.localization import Candidate, LocalizationState, MapPose, PlanarPose
from giraff_schemas.trouble import Trouble
from tests.unit.cli.samples import START, at


def map_pose(
    robot_ns: int | None,
    pose: Pose = START,
    state: LocalizationState = "localized",
    reason: str = "",
    **more: float,
) -> MapPose:
    """`robot_ns`: None: before any odometry."""
    rivals = 3 if state == "ambiguous" else 0
    return MapPose(
        state=state,
        x=pose.x,
        y=pose.y,
        yaw=pose.yaw,
        covariance=(0.0009, 0.0, 0.0, 0.0016, 0.0, 0.0004),
        odom=PlanarPose(x=1.5, y=2.2, yaw=0.0),
        candidates=(Candidate(x=pose.x, y=pose.y, yaw=pose.yaw, belief=0.3),) * rivals,
        explained=more.get("explained", 0.93),
        way=more.get("way", 0.0),
        particles=1000,
        map="" if state == "no_map" else "hall",
        reason=Trouble(reason),
        tick=None if robot_ns is None else at(robot_ns),
    )
