"""Write maps of map_server for tests."""

import numpy as np
from PIL import Image

KEYS = {
    "image": "m.pgm",
    "resolution": "0.05",
    "origin": "[0, 0, 0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}


def write_map(directory, pixels, **keys):
    """A map of grey pixels (rows, columns[, channels]) uint8, the first row on top; the path of its YAML file."""
    Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(str(directory / {**KEYS, **keys}["image"]))
    return write_yaml(directory, yaml_of(**keys))


def write_yaml(directory, text):
    path = directory / "m.yaml"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    return str(path)


def room(columns=40, rows=30):
    """A room's pixels: free within walls one cell thick."""
    pixels = np.full((rows, columns), 254)
    pixels[[0, -1]] = pixels[:, [0, -1]] = 0
    return pixels


def yaml_of(**changed):
    return "".join(f"{key}: {value}\n" for key, value in {**KEYS, **changed}.items())
