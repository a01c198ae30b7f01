"""Read map_server's occupancy grid maps as worlds."""
