"""Fixtures of the unit tests. Shared functions are in support.py: `import conftest` may find another folder's file."""

from subscriber_links import connected_by_hand
from support import burger, simulator

__all__ = ["burger", "connected_by_hand", "simulator"]
