"""The robot file and the environment."""
