"""What the web page is made of, without ROS: scene, texts, values. `ros.web` makes the parts of the page of it."""
