"""Floor plans: the simulator's rooms and ROS's occupancy grids, as walls."""
