"""The robots' cameras: who has one, and what they see."""

from typing import Callable, Dict, Optional, Sequence

from ..geometry import Pose3D, compose3
from ..robot.model import RobotModel
from ..sensors.camera import CameraImage, CameraSpec, ImageRenderer
from ..sim_params import CameraParams
from ..world.model import World

MakeRenderer = Callable[[World, Sequence[RobotModel]], ImageRenderer]


class Cameras:
    """At most one camera per robot. The renderer holds the world, so it is made again after the world has changed."""

    def __init__(
        self, models: Sequence[RobotModel], params: CameraParams, make_renderer: Optional[MakeRenderer]
    ) -> None:
        """Without a renderer there are no images."""
        self._models = tuple(models)
        self._params = params
        self._make_renderer = make_renderer
        self._renderer: Optional[ImageRenderer] = None  # made for the first image

    def spec(self, robot: int) -> Optional[CameraSpec]:
        """The camera of a robot; None if its model has none."""
        model = self._models[robot]
        return None if model.base_from_camera is None else self._params.spec(model.name)

    def images(
        self, world: World, world_from_bases: Sequence[Pose3D], robots: Sequence[int], time: float
    ) -> Dict[int, CameraImage]:
        """Images of those of `robots` that have a camera, at a time [s]."""
        if self._make_renderer is None:
            return {}
        if self._renderer is None:
            self._renderer = self._make_renderer(world, self._models)
        images = {}
        for robot in robots:
            spec, base_from_camera = self.spec(robot), self._models[robot].base_from_camera
            if spec is not None and base_from_camera is not None:
                world_from_camera = compose3(world_from_bases[robot], base_from_camera)
                images[robot] = self._renderer.render(spec, world_from_camera, robot, world_from_bases, time)
        return images

    def close(self) -> None:
        """Free the renderer; the next image makes a new one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
