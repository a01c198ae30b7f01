"""Read Gazebo's SDF files as worlds."""
