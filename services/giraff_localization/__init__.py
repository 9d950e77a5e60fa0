"""Where the robot is on a map: Monte Carlo localization with a few ultrasonic sensors."""
