"""How far a point or a disc can move along a straight displacement before it meets circles or segments."""

import numpy as np

CONTACT_MARGIN = 1e-6  # [m] kept free, so that rounding never moves a disc into a wall


def with_margin(fraction: float, length: float) -> float:
    """The fraction of a displacement of this length [m] that keeps the contact margin; 1 if nothing is met."""
    return fraction if fraction >= 1.0 else max(0.0, fraction - CONTACT_MARGIN / length)


def end_circles(segments: np.ndarray, radius: float) -> np.ndarray:
    """The ends of segments (m, 2, 2) as circles (2 m, 3) of one radius [m]."""
    points = segments.reshape(-1, 2)
    return np.column_stack([points, np.full(len(points), radius)])


def distances_to_segments(point: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distances (m,) [m] from a point (2,) to segments (m, 2, 2)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    offset = point - start
    nearest = np.clip((offset * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-30), 0.0, 1.0)
    return np.hypot(*(offset - nearest[:, None] * along).T)


def fraction_to_circles(start: np.ndarray, move: np.ndarray, circles: np.ndarray) -> float:
    """Fraction of a displacement until a point first enters one of the circles (m, 3); it may leave one freely."""
    if not len(circles):
        return 1.0
    offset = circles[:, :2] - start
    towards = offset @ move
    squared = float(move @ move)
    if squared == 0.0:
        return 1.0
    root = towards**2 - squared * ((offset**2).sum(axis=1) - circles[:, 2] ** 2)
    fraction = (towards - np.sqrt(np.maximum(root, 0.0))) / squared
    met = (root > 0.0) & (towards > 0.0) & (fraction < 1.0)
    return max(0.0, float(fraction[met].min())) if met.any() else 1.0


def fraction_to_sides(start: np.ndarray, move: np.ndarray, segments: np.ndarray, radius: float) -> float:
    """Fraction of a displacement until a point is within `radius` [m] of a segment (m, 2, 2), its ends excluded."""
    if not len(segments):
        return 1.0
    along = segments[:, 1] - segments[:, 0]
    length = np.hypot(along[:, 0], along[:, 1])
    along = along / length[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    offset = start - segments[:, 0]
    distance = (offset * normal).sum(axis=1)
    side = np.where(distance >= 0.0, 1.0, -1.0)
    approach = -(normal @ move) * side
    approaching = approach > 0.0
    fraction = np.full(len(segments), 1.0)
    with np.errstate(over="ignore"):  # almost parallel: never met
        fraction[approaching] = np.maximum((np.abs(distance[approaching]) - radius) / approach[approaching], 0.0)
    fraction = np.minimum(fraction, 1.0)
    position = ((offset + fraction[:, None] * move) * along).sum(axis=1)
    met = (fraction < 1.0) & (position >= 0.0) & (position <= length)
    return float(fraction[met].min()) if met.any() else 1.0
