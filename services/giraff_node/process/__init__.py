"""The process: its loop, health, logs, clock, and the files that it keeps over restarts."""
