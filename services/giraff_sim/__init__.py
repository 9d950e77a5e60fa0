"""The simulated robot: the boards' real firmware, the world around their pins, a serial port for each."""
