"""Fixtures of the unit tests. What tests import is in support.py: pytest may take another folder's conftest for it."""

from support import burger, simulator

__all__ = ["burger", "simulator"]
