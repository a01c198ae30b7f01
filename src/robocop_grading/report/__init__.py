"""A grade -> the files of its report."""
