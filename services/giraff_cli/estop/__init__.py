"""`giraff estop`: engage, reset, status."""
