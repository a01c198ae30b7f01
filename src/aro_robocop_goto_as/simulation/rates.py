"""The sensors and ticks of a simulation by name, and how often each is due."""

from typing import Dict

from ..sim_params import SimParams

CLOCK, CONTROL = "clock", "control"
SCAN, ODOM, JOINTS, IMU, GROUND_TRUTH = "scan", "odom", "joints", "imu", "ground_truth"
BUMPER, CAMERA, TF = "bumper", "camera", "tf"


def rates_of(p: SimParams) -> Dict[str, int]:
    """How often each sensor and tick is due [Hz], in the order in which they are measured; 0 = never."""
    rates = p.rates
    return {
        CLOCK: rates.clock_rate,
        CONTROL: rates.control_rate,
        GROUND_TRUTH: rates.ground_truth_rate,
        IMU: rates.imu_rate,
        JOINTS: rates.joint_state_rate,
        ODOM: rates.odom_rate,
        SCAN: p.scan.rate,
        BUMPER: rates.bumper_rate,
        CAMERA: rates.camera_rate,
        TF: rates.odom_rate,
    }
