"""`giraff ros2`: the robot as a node of ROS 2, in this terminal."""
