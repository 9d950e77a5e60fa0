"""Tests beside one robot. pytest ends it with the last of them, since this folder is a package."""
