"""Giraff PC: the ultrasonic sensors of the ranger board become ranges, its bumpers bumps."""
