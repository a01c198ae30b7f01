"""The transforms between frames, of the last seconds.

This is not tf2's buffer, which refuses transforms older than those that it holds: after a restart of the simulator,
whose time begins at zero again, it would keep the poses of the previous run.
"""

from collections import deque
from typing import Deque, Dict, List, Optional, Tuple

from ..geometry import Pose3D, compose3, inverse3

MAX_CHAIN = 100  # frames from a root to a leaf; longer ones are loops
KEPT = 5.0  # [s] of a frame's transforms: longer than a scan waits to be drawn on a busy machine
History = Deque[Tuple[float, Pose3D]]  # stamp [s], parent_from_child; the newest last


class FrameTree:
    """Frames with their parents, whatever the age of the transforms."""

    def __init__(self) -> None:
        self._parents: Dict[str, Tuple[str, History]] = {}

    def update(self, parent: str, child: str, parent_from_child: Pose3D, stamp: float = 0.0) -> None:
        """Store a child's newest transform [s]; another parent, or an earlier stamp, replaces all of its transforms."""
        before, history = self._parents.get(child, (parent, deque()))
        if before != parent or (history and stamp <= history[-1][0]):
            history = deque()
        self._parents[child] = (parent, history)
        history.append((stamp, parent_from_child))
        while history[0][0] < stamp - KEPT:
            history.popleft()

    def names(self) -> List[str]:
        """All frames: roots first, then their children, and so on."""
        names = {*self._parents, *(parent for parent, _ in self._parents.values())}
        return sorted(names, key=lambda name: (len(self._chain(name)), name))

    def knows(self, frame: str) -> bool:
        """Return whether a transform to or from the frame has been received."""
        return frame in self._parents or any(parent == frame for parent, _ in self._parents.values())

    def lookup(self, target: str, source: str, stamp: Optional[float] = None) -> Optional[Pose3D]:
        """target_from_source by the newest transforms, or by those nearest to a stamp [s]; None if not connected."""
        from_target = dict(self._chain(target, stamp))
        for ancestor, from_source in self._chain(source, stamp):
            if ancestor == target:
                return from_source
            if ancestor in from_target:
                return compose3(inverse3(from_target[ancestor]), from_source)
        return None

    def _chain(self, frame: str, stamp: Optional[float] = None) -> List[Tuple[str, Pose3D]]:
        """The frame and its ancestors, each with ancestor_from_frame."""
        chain = [(frame, Pose3D())]
        while len(chain) < MAX_CHAIN and frame in self._parents:
            frame, history = self._parents[frame]
            pose = history[-1][1] if stamp is None else _nearest(history, stamp)
            chain.append((frame, compose3(pose, chain[-1][1])))
        return chain


def _nearest(history: History, stamp: float) -> Pose3D:
    return min(history, key=lambda kept: abs(kept[0] - stamp))[1]
