"""The process: its loop, health, logs, and the files that it keeps over restarts."""
