"""What giraff_localization says of a robot, as a test has it."""

from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_schemas.localization import Candidate, LocalizationState, MapPose, PlanarPose
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import Trouble

LOST: Final = "it is lost; drive it 2 m along walls, or say where it is with `giraff localize`"


def map_pose(
    odom: Pose,
    robot: Pose,
    tick: RobotTime | None,
    state: LocalizationState = "localized",
    candidates: tuple[Candidate, ...] = (),
) -> MapPose:
    """`odom`: where that is in `map`; `robot`: where that is in `odom`."""
    here = robot.placed_in(odom)
    return MapPose(
        state=state,
        x=here.x,
        y=here.y,
        yaw=here.yaw,
        covariance=(0.01, 0.0, 0.0, 0.01, 0.0, 0.001),
        odom=PlanarPose(x=odom.x, y=odom.y, yaw=odom.yaw),
        candidates=candidates,
        explained=0.9,
        way=0.0,
        particles=1000,
        map="flat",
        reason=Trouble("" if state == "localized" else LOST),
        tick=tick,
    )
