"""Orientation of reference frames, for symbols, numbers and batches.

Direction cosine matrices ${}^A\\mathbf{C}^N$ have $A$'s unit vectors as rows, angles are in
radians, quaternions have their scalar part first, and sequences are body fixed and lower case.
Matrices, quaternions and axes in single precision are checked to that precision, and give results
in single precision.
"""

from .angular_velocity import (
    angular_velocity_from_dcm_rate,
    angular_velocity_matrix,
    dcm_rate,
    quaternion_rate,
    rotation_vector_rate,
)
from .axis_angle import axis_angle_from_dcm, dcm_from_axis_angle, quaternion_from_axis_angle
from .comparison import Diagnosis, diagnose, same_orientation
from .derivatives import jacobian, propagate_covariance
from .direction_cosines import NearestDCM, check_dcm, nearest_dcm, simple_dcm
from .euler_angles import (
    PROPER_EULER,
    SEQUENCES,
    TAIT_BRYAN,
    body_fixed_from_dcm,
    dcm_from_body_fixed,
    dcm_from_space_fixed,
    gimbal_lock_margin,
    space_fixed_from_dcm,
)
from .filters import MultiplicativeKalmanFilter, smooth
from .frames import Frames
from .integration import dcms_after_turns, turns_from_angular_velocity
from .metrics import angle_between, mean_orientation, random_orientations
from .numbers_and_symbols import SymbolsNotPossible
from .observations import dcm_from_directions, dcm_from_two_directions, directions_covariance
from .quaternions import (
    dcm_from_quaternion,
    interpolate_quaternions,
    multiply_quaternions,
    quaternion_from_dcm,
)
from .rodrigues_parameters import (
    dcm_from_modified_rodrigues,
    dcm_from_rodrigues,
    modified_rodrigues_from_dcm,
    rodrigues_from_dcm,
    shadow_of_modified_rodrigues,
)
from .rotation_vector import dcm_from_rotation_vector, rotation_vector_from_dcm
from .scipy_border import dcm_from_scipy_rotation, scipy_rotation_from_dcm

__version__ = "1.0.0"

__all__ = [
    "Diagnosis",
    "Frames",
    "MultiplicativeKalmanFilter",
    "NearestDCM",
    "PROPER_EULER",
    "SEQUENCES",
    "SymbolsNotPossible",
    "TAIT_BRYAN",
    "angle_between",
    "angular_velocity_from_dcm_rate",
    "angular_velocity_matrix",
    "axis_angle_from_dcm",
    "body_fixed_from_dcm",
    "check_dcm",
    "dcm_from_axis_angle",
    "dcm_from_directions",
    "dcm_from_two_directions",
    "directions_covariance",
    "dcm_from_body_fixed",
    "dcm_from_modified_rodrigues",
    "dcm_from_quaternion",
    "dcm_from_rodrigues",
    "dcm_from_rotation_vector",
    "dcm_from_scipy_rotation",
    "dcm_from_space_fixed",
    "dcm_rate",
    "dcms_after_turns",
    "diagnose",
    "gimbal_lock_margin",
    "interpolate_quaternions",
    "jacobian",
    "mean_orientation",
    "modified_rodrigues_from_dcm",
    "multiply_quaternions",
    "nearest_dcm",
    "propagate_covariance",
    "quaternion_from_axis_angle",
    "quaternion_from_dcm",
    "quaternion_rate",
    "random_orientations",
    "rodrigues_from_dcm",
    "rotation_vector_from_dcm",
    "rotation_vector_rate",
    "same_orientation",
    "scipy_rotation_from_dcm",
    "shadow_of_modified_rodrigues",
    "simple_dcm",
    "smooth",
    "space_fixed_from_dcm",
    "turns_from_angular_velocity",
]
