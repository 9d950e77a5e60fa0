"""Serial ports, and the boards behind them."""
