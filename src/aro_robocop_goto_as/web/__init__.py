"""The web page, without ROS: what it shows and what it makes of input. `ros.web` connects it to topics and services."""
