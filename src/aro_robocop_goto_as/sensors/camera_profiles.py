"""Image sizes and fields of view of the cameras, by profile and model."""

from typing import Dict, Tuple

Figures = Tuple[int, int, float]  # width, height [pixels], horizontal field of view [rad]

SMALL: Figures = (160, 120, 1.02974)  # the field of view in turtlebot3_description's URDF; small images cost less
# By the models' names in their URDF. Figures of the camera plug-ins in turtlebot3_gazebo (noetic).
PROFILES: Dict[str, Dict[str, Figures]] = {
    "small": {},
    "gazebo": {"turtlebot3_waffle": (1920, 1080, 1.3439), "turtlebot3_waffle_pi": (640, 480, 1.0856)},
}


def camera_of(profile: str, model: str) -> Figures:
    """The figures of a model's camera in a profile; those of SMALL where the profile has none."""
    return PROFILES[profile].get(model, SMALL)
