"""The sensors, one a module, and catalog, the list of them. A module has a sensor's parameters and measurements."""
