"""Clients of the go-to action: the RViz bridge robocop_rviz_goto_ac, and what `robocop goto` shares with it."""
