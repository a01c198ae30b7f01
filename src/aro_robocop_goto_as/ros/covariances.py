"""The covariances of /odom, /ground_truth_odom and /imu."""

from typing import List, Tuple

from ..sensors.imu import ImuParams

# Variances of x, y, z, roll, pitch, yaw. A huge variance marks what a differential drive cannot measure. The figures
# are those of Gazebo's differential drive plugin, which existing lab code was written against.
ODOM_VARIANCES = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)
TRUTH_VARIANCES = (1e-12,) * 6
ORIENTATION_VARIANCE = 1e-6  # the simulated IMU's orientation is exact except for rounding
REAL_IMU_VARIANCES = (0.0025, 0.02, 0.04)  # orientation, rates, accelerations of a TurtleBot3's firmware

ImuCovariances = Tuple[List[float], List[float], List[float]]  # of orientation, rates, accelerations


def diagonal(variances: Tuple[float, ...]) -> List[float]:
    """A row-major diagonal covariance, 6 x 6 or 3 x 3, with these variances."""
    size = len(variances)
    return [variances[row] if row == column else 0.0 for row in range(size) for column in range(size)]


def odom_covariance(real: bool) -> List[float]:
    """That of pose and twist: as Gazebo's plugin sends it, or zeros, as a real TurtleBot3 does."""
    return diagonal((0.0,) * 6 if real else ODOM_VARIANCES)


def imu_covariances(noise: ImuParams, real: bool) -> ImuCovariances:
    """The covariances of the noise that the simulator adds, or those that a real TurtleBot3 reports."""
    variances = (
        REAL_IMU_VARIANCES if real else (ORIENTATION_VARIANCE, noise.gyro_noise**2, noise.accelerometer_noise**2)
    )
    orientation, rates, accelerations = (diagonal((variance,) * 3) for variance in variances)
    return orientation, rates, accelerations
