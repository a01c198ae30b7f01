"""robocop_web: the page of package `web`, fed from topics and tf, and its requests as topics and service calls."""
