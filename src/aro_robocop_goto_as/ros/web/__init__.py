"""robocop_web: the page of package `web`, one module per part; `node` makes and updates them."""
