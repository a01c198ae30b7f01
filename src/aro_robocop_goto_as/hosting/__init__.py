"""Other people's packages: found, built in a workspace of their own, run against this simulator."""
