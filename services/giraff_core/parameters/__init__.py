"""Parameters of a service that can be read and changed while it runs."""
