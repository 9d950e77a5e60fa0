"""`giraff calibrate joystick`: how the tilt sensor sits in the joystick."""
