"""The cameras of the robots whose models have one."""

from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple

from ..geometry import compose3
from ..param_loading import PROFILES_OWN, parameter, positive
from .camera_image import CameraImage, CameraSpec
from .sensor import RateParams, RobotIndices, Sensor, SensorContext

Figures = Tuple[int, int, float]  # width, height [pixels], horizontal field of view [rad]

SMALL: Figures = (160, 120, 1.02974)  # the field of view in turtlebot3_description's URDF; small images cost less
# By the models' names in their URDF. Figures of the camera plug-ins in turtlebot3_gazebo (noetic).
PROFILES: Dict[str, Dict[str, Figures]] = {
    "small": {},
    "gazebo": {"turtlebot3_waffle": (1920, 1080, 1.3439), "turtlebot3_waffle_pi": (640, 480, 1.0856)},
}


@dataclass(frozen=True)
class CameraParams(RateParams):
    """The cameras: a profile, figures that replace its own, and how often they take images."""

    camera_profile: str = parameter(
        "small",
        choices=tuple(PROFILES),
        about="small: 160 x 120 pixels, 1.02974 rad as in turtlebot3_description; gazebo: as turtlebot3_gazebo's",
    )
    camera_width: Optional[int] = parameter(None, 1, 4096, "[pixels]", otherwise=PROFILES_OWN)
    camera_height: Optional[int] = parameter(None, 1, 4096, "[pixels]", otherwise=PROFILES_OWN)
    camera_angle: Optional[float] = parameter(None, 0.01, 3.0, "[rad] horizontal field of view", otherwise=PROFILES_OWN)
    camera_range_min: float = positive(0.05, "[m] nearer objects are not rendered")
    camera_range_max: float = positive(10.0, "[m] depth beyond is +inf (REP-118)")
    camera_rate: int = parameter(10, low=0, about="[Hz] of models with a camera; 0 = none. An image takes a core 5 ms")

    def spec(self, model: str) -> CameraSpec:
        """The camera of a model, by its name."""
        width, height, angle = PROFILES[self.camera_profile].get(model, SMALL)
        return CameraSpec(
            width if self.camera_width is None else self.camera_width,
            height if self.camera_height is None else self.camera_height,
            angle if self.camera_angle is None else self.camera_angle,
            self.camera_range_min,
            self.camera_range_max,
        )


class Camera(Sensor):
    """specs: of each robot, None for a robot without a camera; images: by robot, only of robots that were due last."""

    topic = "camera"

    def __init__(self, params: CameraParams, context: SensorContext) -> None:
        super().__init__(context, params.camera_rate)
        self.specs: Sequence[Optional[CameraSpec]] = [
            None if model.base_from_camera is None else params.spec(model.name) for model in context.models
        ]
        self.images: Mapping[int, CameraImage] = {}
        self._make_renderer: Any = None
        if any(self.specs):
            from .camera_renderer import CameraRenderer  # imports pybullet

            self._make_renderer = CameraRenderer
        self._renderer: Any = None  # a CameraRenderer of the present world, made for the first image

    def measure(self, robots: RobotIndices) -> None:
        """Take images with these robots' cameras."""
        context, images = self.context, {}
        bases = [context.engine.body(robot).world_from_base for robot in range(len(context.models))]
        for robot in robots:
            spec, base_from_camera = self.specs[robot], context.models[robot].base_from_camera
            if spec is not None and base_from_camera is not None:
                self._renderer = self._renderer or self._make_renderer(context.world, context.models)
                world_from_camera = compose3(bases[robot], base_from_camera)
                images[robot] = self._renderer.render(spec, world_from_camera, robot, bases, context.time)
        self.images = images

    def close(self) -> None:
        """Free the renderer; the next image makes a new one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
