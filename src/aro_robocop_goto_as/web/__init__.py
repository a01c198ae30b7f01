"""What the web page is made of, without ROS: scene, texts, values. `ros.web` builds the parts of the page from it."""
