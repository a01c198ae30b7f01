"""robocop_goto_as: the go-to action server."""
