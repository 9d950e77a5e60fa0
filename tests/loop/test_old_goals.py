"""A goal of rviz that was given long ago moves nothing, in simulated time: motors and pose are the judge."""

from tests.loop.ros import ros_stage


def test_an_old_goal_moves_nothing_and_one_of_now_is_driven_to() -> None:
    with ros_stage() as it:
        it.desk.give_goal(*it.at)  # it is there: this one tells its clock
        for held_for in (60.0, 10.0, 2.0, 0.25):
            it.run(0.1)
            it.desk.give_goal(0.4, 0.0, 0.0, held_for=held_for)
        it.run(1.0)
        assert it.stage.driven_ms(0.0) == 0
        assert "older than those before it" in it.loop.processes["ros2"].told["goal"]
        assert "give it again" in it.loop.processes["ros2"].told["goal"]
        before = it.at
        it.desk.give_goal(0.4, 0.0, 0.0, held_for=0.1)
        it.run(2.0)
        assert it.at[0] > before[0] + 0.1


def test_a_click_that_a_frozen_rviz_held_back_moves_nothing() -> None:
    with ros_stage() as it:
        before = it.at
        for number in range(0, 20, 2):
            it.desk.rviz.is_frozen = True
            it.desk.clicks.append((0.4, 0.0, 0.0))
            it.run(0.4 + 0.01 * number)
            it.desk.rviz.is_frozen = False
            it.run(0.1)  # it answers, and publishes with the time of now
        assert not it.desk.clicks
        it.run(1.1)
        assert it.stage.driven_ms(0.0) == 0
        assert it.at == before
        assert "not been seen awake" in it.loop.processes["ros2"].told["goal"]
        it.desk.clicks.append((0.4, 0.0, 0.0))
        it.run(1.5)
        assert it.at[0] > before[0] + 0.1
