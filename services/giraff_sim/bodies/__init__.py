"""The bodies of simulated robots: one folder for each kind, behind the protocol of `giraff_sim.world.body`."""
