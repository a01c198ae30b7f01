"""The list of all sensors: their parameters, and their instances in one simulation."""

from dataclasses import dataclass
from typing import Dict

from ..param_loading import group
from .bumper import Bumper, BumperParams
from .camera import Camera, CameraParams
from .ground_truth import GroundTruth, TruthParams
from .imu import Imu, ImuParams
from .lidar import Lidar, LidarParams
from .odometry import JointEncoders, OdometryParams, WheelOdometry
from .sensor import Sensor, SensorContext


@dataclass(frozen=True)
class SensorParams:
    """Parameters of the sensors."""

    ground_truth: TruthParams = group(TruthParams)
    imu: ImuParams = group(ImuParams)
    odometry: OdometryParams = group(OdometryParams)
    lidar: LidarParams = group(LidarParams)
    bumper: BumperParams = group(BumperParams)
    camera: CameraParams = group(CameraParams)

    def rates(self) -> Dict[str, int]:
        """The rates [Hz] by the names of their parameters; 0: never."""
        return {name: rate for params in vars(self).values() for name, rate in params.rates().items()}


class Sensors:
    """The sensors of one simulation: attributes that are sensors, in the order in which they measure and publish."""

    def __init__(self, params: SensorParams, context: SensorContext, follows_truth: bool) -> None:
        """`follows_truth`: whether map -> odom is corrected with each odometry."""
        odometry = WheelOdometry(params.odometry, context, follows_truth)
        self.bumper = Bumper(params.bumper, context)
        self.camera = Camera(params.camera, context)
        self.ground_truth = GroundTruth(params.ground_truth, context)
        self.imu = Imu(params.imu, context)
        self.joints = JointEncoders(params.odometry, context, odometry)
        self.odometry = odometry
        self.lidar = Lidar(params.lidar, context)
        self.by_topic: Dict[str, Sensor] = {sensor.topic: sensor for sensor in vars(self).values()}
