"""./robocop: the arguments of its commands, and a report on the system, before anything is installed."""
