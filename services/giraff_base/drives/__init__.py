"""Kinds of drive: one folder for each base firmware, behind the protocol of `giraff_base.drive`."""
