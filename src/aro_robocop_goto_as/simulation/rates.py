"""The sensors and ticks of a simulation by name, and how often happens what is no sensor's own parameter."""

from dataclasses import dataclass

from ..param_loading import parameter

CLOCK, CONTROL = "clock", "control"
SCAN, ODOM, JOINTS, IMU, GROUND_TRUTH = "scan", "odom", "joints", "imu", "ground_truth"
BUMPER, CAMERA, TF = "bumper", "camera", "tf"


@dataclass(frozen=True)
class Rates:
    """How often each thing happens [Hz]; 0 = never. A sensor's own parameters have its rate."""

    physics_rate: int = parameter(240, low=1, high=10000)
    clock_rate: int = parameter(60, low=1)
    control_rate: int = parameter(10, low=1)  # lockstep control ticks
    joint_state_rate: int = parameter(30, low=1)
    ground_truth_rate: int = parameter(30, low=1)
    bumper_rate: int = parameter(30, low=0)
