"""./robocop: its commands, set-up and look at the system, with nothing but the standard library."""
