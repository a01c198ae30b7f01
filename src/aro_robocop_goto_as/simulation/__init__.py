"""The simulation without ROS: robots in a world, stepped in simulated time, paced and kept in lockstep."""
