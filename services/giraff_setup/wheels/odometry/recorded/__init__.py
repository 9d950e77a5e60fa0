"""Runs that were recorded elsewhere, with the true poses of a tracking system beside the counts."""
