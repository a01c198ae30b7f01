"""Bounds of what comes from outside."""

FARTHEST = 1e6  # [m] from the origin; beyond, single-precision messages no longer resolve centimetres
