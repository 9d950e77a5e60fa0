"""The body that balances on two wheels."""
