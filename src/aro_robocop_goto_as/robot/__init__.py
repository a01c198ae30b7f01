"""A robot's URDF and figures, and its base controller: velocity commands -> wheel speeds."""
