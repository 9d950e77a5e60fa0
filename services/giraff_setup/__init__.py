"""Tools that set a robot up: measurements, fits, drawings and files, in folders named by the thing that they set up."""
