"""Other people's files: archives and folders that nobody trusts, and folders for what is temporary."""
