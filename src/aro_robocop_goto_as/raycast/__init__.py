"""Exact distances from scanners to the world along their beams."""
