"""The sensors and ticks of a simulation by name, and how often each is due."""

from dataclasses import dataclass
from typing import Dict

from ..param_loading import parameter

CLOCK, CONTROL = "clock", "control"
SCAN, ODOM, JOINTS, IMU, GROUND_TRUTH = "scan", "odom", "joints", "imu", "ground_truth"
BUMPER, CAMERA, TF = "bumper", "camera", "tf"


@dataclass(frozen=True)
class Rates:
    """How often each thing happens or is measured [Hz]; 0 = never. The scanner's is in ScanParams."""

    physics_rate: int = parameter(240, low=1, high=10000)
    clock_rate: int = parameter(60, low=1)
    control_rate: int = parameter(10, low=1)  # lockstep control ticks
    odom_rate: int = parameter(30, low=1)
    joint_state_rate: int = parameter(30, low=1)
    ground_truth_rate: int = parameter(30, low=1)
    imu_rate: int = parameter(200, low=1)
    bumper_rate: int = parameter(30, low=0)
    camera_rate: int = parameter(10, low=0)


def rates_of(rates: Rates, scan_rate: int) -> Dict[str, int]:
    """How often each sensor and tick is due [Hz], in the order in which they are measured; 0 = never."""
    return {
        CLOCK: rates.clock_rate,
        CONTROL: rates.control_rate,
        GROUND_TRUTH: rates.ground_truth_rate,
        IMU: rates.imu_rate,
        JOINTS: rates.joint_state_rate,
        ODOM: rates.odom_rate,
        SCAN: scan_rate,
        BUMPER: rates.bumper_rate,
        CAMERA: rates.camera_rate,
        TF: rates.odom_rate,
    }
