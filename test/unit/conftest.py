"""Fixtures of the unit tests. Shared functions are in support.py: `import conftest` may find another folder's file."""

from support import burger, simulator

__all__ = ["burger", "simulator"]
