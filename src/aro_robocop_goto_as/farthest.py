"""The bound of what is accepted from outside: positions beyond it are refused."""

FARTHEST = 1e6  # [m] from the origin; beyond, single-precision messages no longer resolve centimetres
