"""Codecs of the frames that `wire` does not have. Each is generated from the header of a board."""
