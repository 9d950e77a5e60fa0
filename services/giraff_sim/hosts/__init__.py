"""The machines around the boards, in simulated time: clocks, processes, cables and the network between them."""
