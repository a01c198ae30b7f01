"""Programs that the commands of ./robocop start, beside the nodes."""
