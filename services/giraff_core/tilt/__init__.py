"""What an accelerometer in a hand asks for, whatever the accelerometer is: a joystick's, or a phone's."""
