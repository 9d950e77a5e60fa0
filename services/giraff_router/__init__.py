"""The router: a host with a known address through which the robots' sites and the operators' hear each other."""
