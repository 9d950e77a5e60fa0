"""`giraff calibrate ranger`: where ultrasonic sensors sit and look, and their scale, by a wall."""
