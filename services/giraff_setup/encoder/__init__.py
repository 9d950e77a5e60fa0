"""Encoders: printed disks, and both channels as the board sees them."""
