"""Sensor models: measurements from the states of robots and from exact distances, one sensor per file."""
