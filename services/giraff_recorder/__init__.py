"""The flight recorder: the last minute in memory, on disk when something went wrong."""
