"""The newest transforms between frames.

This is not tf2's buffer, which refuses transforms older than those that it holds: after a restart of the simulator,
whose time begins at zero again, it would keep the poses of the previous run.
"""

from typing import Dict, List, Optional, Tuple

from ..geometry import Pose3D, compose3, inverse3

MAX_CHAIN = 100  # frames from a root to a leaf; longer ones are loops


class FrameTree:
    """Frames with their parents, whatever the age of the transforms."""

    def __init__(self) -> None:
        self._parents: Dict[str, Tuple[str, Pose3D]] = {}

    def update(self, parent: str, child: str, parent_from_child: Pose3D) -> None:
        """Store a transform in place of the child's former one."""
        self._parents[child] = (parent, parent_from_child)

    def names(self) -> List[str]:
        """All frames: roots first, then their children, and so on."""
        names = {*self._parents, *(parent for parent, _ in self._parents.values())}
        return sorted(names, key=lambda name: (len(self._chain(name)), name))

    def knows(self, frame: str) -> bool:
        """Return whether a transform to or from the frame has been received."""
        return frame in self._parents or any(parent == frame for parent, _ in self._parents.values())

    def lookup(self, target: str, source: str) -> Optional[Pose3D]:
        """target_from_source, or None if the frames are not connected."""
        from_target = dict(self._chain(target))
        for ancestor, from_source in self._chain(source):
            if ancestor == target:
                return from_source
            if ancestor in from_target:
                return compose3(inverse3(from_target[ancestor]), from_source)
        return None

    def _chain(self, frame: str) -> List[Tuple[str, Pose3D]]:
        """The frame and its ancestors, each with ancestor_from_frame."""
        chain = [(frame, Pose3D())]
        while len(chain) < MAX_CHAIN and frame in self._parents:
            frame, pose = self._parents[frame]
            chain.append((frame, compose3(pose, chain[-1][1])))
        return chain
