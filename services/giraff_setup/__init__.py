"""What sets a robot up: measurements, fits, drawings and files, named by the thing that they set up."""
