"""The list of all sensors: their parameters, and their instances in one simulation."""

from dataclasses import dataclass
from typing import Dict

from ..param_loading import group
from .bumper import BumperParams, Bumpers
from .camera import CameraParams, Cameras
from .ground_truth import GroundTruth, TruthParams
from .imu import ImuParams, Imus
from .lidar import Scanner
from .odometry import Joints, Odometers, OdometryParams, Transforms
from .scan_profiles import ScanParams
from .sensor import Sensor, Site


@dataclass(frozen=True)
class SensorParams:
    """Parameters of the sensors; the names of their rates end with _rate."""

    ground_truth: TruthParams = group(TruthParams)
    imu: ImuParams = group(ImuParams)
    odometry: OdometryParams = group(OdometryParams)
    scan: ScanParams = group(ScanParams)
    bumper: BumperParams = group(BumperParams)
    camera: CameraParams = group(CameraParams)

    def rates(self) -> Dict[str, int]:
        """The rates [Hz] by the names of their parameters."""
        given = {name: value for one in vars(self).values() for name, value in vars(one).items()}
        rates = {name: value for name, value in given.items() if name.endswith("_rate")}
        return {**rates, "scan_rate": self.scan.lidar().rate}


class Sensors:
    """The sensors of one simulation: attributes that are sensors, in the order in which they measure a step."""

    def __init__(self, params: SensorParams, site: Site, follows_truth: bool) -> None:
        """`follows_truth`: whether map -> odom is corrected with each odometry."""
        self.ground_truth = GroundTruth(params.ground_truth, site)
        self.imu = Imus(params.imu, site)
        self.odometry = Odometers(params.odometry, site, follows_truth)
        self.joints = Joints(params.odometry, site, self.odometry)
        self.scan = Scanner(params.scan, site)
        self.bumper = Bumpers(params.bumper, site)
        self.camera = Cameras(params.camera, site)
        self.transforms = Transforms(site, params.odometry.odom_rate)
        sensors = [sensor for sensor in vars(self).values() if isinstance(sensor, Sensor)]
        self.by_name: Dict[str, Sensor] = {sensor.name: sensor for sensor in sensors}
