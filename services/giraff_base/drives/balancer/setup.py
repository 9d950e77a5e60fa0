"""Parts of the balancer's drive that find gains: the loop by which base judges them, and the robot's response."""

from giraff_base.drives.balancer.response import LEASH, respond
from giraff_base.drives.balancer.stability import DELAYS, MARGIN, PERIOD, Gains, Loop

__all__ = ["DELAYS", "LEASH", "MARGIN", "PERIOD", "Gains", "Loop", "respond"]
