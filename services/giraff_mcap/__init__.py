"""Recordings: MCAP files of everything that a robot says, for this project and any tool that reads MCAP."""
