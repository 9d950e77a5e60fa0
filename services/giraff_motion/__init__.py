"""An operator that others ask for motions by metres and radians."""
