"""Exact distances from sensors to the world along their beams."""
