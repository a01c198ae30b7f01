"""Commands + World -> robot states. engine.py states the interface; bullet and kinematic implement it."""
