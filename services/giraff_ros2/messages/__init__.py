"""From samples of the robot to ROS messages."""
