"""`giraff check`: what a robot must have passed before it drives."""
