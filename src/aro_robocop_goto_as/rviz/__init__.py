"""What RViz shows, as the text of its configuration file: displays, camera, window. Pure; nothing here starts RViz."""
