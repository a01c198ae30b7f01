"""Other people's files: archives and folders that are not trusted; and temporary folders."""
