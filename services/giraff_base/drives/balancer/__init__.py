"""A robot that balances, on the firmware `firmware/balancer`. Its safe state is to stand without driving."""
