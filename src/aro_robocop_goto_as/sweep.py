"""A point or a disc on its way along a straight displacement -> how far it comes, among circles and segments."""

import numpy as np

SKIN = 1e-6  # [m] kept free, so that rounding never puts a disc inside a wall


def short_of(share: float, length: float) -> float:
    """The share that keeps the skin free; 1 where nothing is met."""
    return share if share >= 1.0 else max(0.0, share - SKIN / length)


def ends(segments: np.ndarray, radius: float) -> np.ndarray:
    """The ends of segments (m, 2, 2) as circles (2 m, 3) of one radius."""
    points = segments.reshape(-1, 2)
    return np.column_stack([points, np.full(len(points), radius)])


def to_segments(point: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distances (m,) [m] from a point (2,) to segments (m, 2, 2)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    offset = point - start
    share = np.clip((offset * along).sum(axis=1) / np.maximum((along ** 2).sum(axis=1), 1e-30), 0.0, 1.0)
    return np.hypot(*(offset - share[:, None] * along).T)


def share_to_circles(start: np.ndarray, move: np.ndarray, circles: np.ndarray) -> float:
    """Share of a displacement until it first enters a circle (m, 3); leaving one that it is in is free."""
    if not len(circles):
        return 1.0
    offset = circles[:, :2] - start
    towards = offset @ move
    squared = float(move @ move)
    if squared == 0.0:
        return 1.0
    root = towards ** 2 - squared * ((offset ** 2).sum(axis=1) - circles[:, 2] ** 2)
    share = (towards - np.sqrt(np.maximum(root, 0.0))) / squared
    met = (root > 0.0) & (towards > 0.0) & (share < 1.0)
    return max(0.0, float(share[met].min())) if met.any() else 1.0


def share_to_sides(start: np.ndarray, move: np.ndarray, segments: np.ndarray, radius: float) -> float:
    """Share of a displacement until it comes within `radius` of the flat side of a segment (m, 2, 2)."""
    if not len(segments):
        return 1.0
    along = segments[:, 1] - segments[:, 0]
    length = np.hypot(along[:, 0], along[:, 1])
    along = along / length[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    offset = start - segments[:, 0]
    away = (offset * normal).sum(axis=1)
    side = np.where(away >= 0.0, 1.0, -1.0)
    approach = -(normal @ move) * side
    nearing = approach > 0.0
    share = np.full(len(segments), 1.0)
    with np.errstate(over="ignore"):  # hardly nearing: never met
        share[nearing] = np.maximum((np.abs(away[nearing]) - radius) / approach[nearing], 0.0)
    share = np.minimum(share, 1.0)
    touch = ((offset + share[:, None] * move) * along).sum(axis=1)
    met = (share < 1.0) & (touch >= 0.0) & (touch <= length)
    return float(share[met].min()) if met.any() else 1.0
