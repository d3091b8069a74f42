"""Typed, frozen settings of robots, prey, arenas and protocols, read from TOML.

Every key has a unit, a range and a default here, and nowhere else. A wrong key or value is a
:class:`~bayeshunt.core.errors.ConfigError` of one line that names the file, the key and the fix.
"""

from bayeshunt.config.schema.arena import ArenaSettings
from bayeshunt.config.schema.bodies import BodySettings, DiscSettings, DriveSettings, GaitSettings, NoiseSettings
from bayeshunt.config.schema.experiment import ExperimentSettings
from bayeshunt.config.schema.groups import Settings
from bayeshunt.config.schema.model import ModelSettings
from bayeshunt.config.schema.obstacles import ObstacleSettings
from bayeshunt.config.schema.prey import PreySettings
from bayeshunt.config.schema.protocol import PhysicsSettings, ProtocolSettings
from bayeshunt.config.schema.robot import RobotSettings
from bayeshunt.config.schema.sensing import SensingSettings

__all__ = [
    "ArenaSettings",
    "BodySettings",
    "DiscSettings",
    "DriveSettings",
    "ExperimentSettings",
    "GaitSettings",
    "ModelSettings",
    "NoiseSettings",
    "ObstacleSettings",
    "PhysicsSettings",
    "PreySettings",
    "ProtocolSettings",
    "RobotSettings",
    "SensingSettings",
    "Settings",
]
