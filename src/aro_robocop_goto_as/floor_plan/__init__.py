"""Where on the floor of a world there is room: the obstacles around a point, free places for robots, the map."""
