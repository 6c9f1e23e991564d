"""Makes the camera that the settings name; the only place that knows all makes.

The library of a make is imported only if its camera is used.
"""

from station.camera.port import Camera
from station.settings.camera import AnyCamera, PylonSettings, ReplaySettings


def make_camera(settings: AnyCamera) -> Camera:
    """Return the camera that the settings name, not yet open."""
    match settings:
        case PylonSettings():
            from station.camera.pylon import PylonCamera

            return PylonCamera(settings)
        case ReplaySettings():
            from station.camera.replay import ReplayCamera

            return ReplayCamera(settings)
