"""robocop_sim: the simulation's topics and services."""
