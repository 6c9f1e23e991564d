"""Takes setup images: images for adjusting camera and light, neither judged nor recorded."""

import numpy as np

from station.camera.reconnecting import ReconnectingCamera
from station.channel.events import SETUP_IMAGE, Preview, SetupImageEvent
from station.channel.preview import make_preview
from station.engine.orders import Service
from station.errors import LocateError, ModelError
from station.inspection.inspector import Inspector
from station.vision.quality import measure
from station.vision.unwrap import unwrap

BINS = 64
"""Number of grey-level bins of the histogram."""


def take_setup_image(
    camera: ReconnectingCamera, inspector: Inspector, request: Service
) -> tuple[SetupImageEvent, Preview | None]:
    """Take one image and return its quality and preview; without a frame there is no preview."""
    camera.adjust(request.exposure_us, request.gain_db)
    grab = camera.grab()
    if grab.frame is None:
        event = SetupImageEvent(
            exposure_us=request.exposure_us,
            gain_db=request.gain_db,
            mean_dn=0.0,
            saturated_share=0.0,
            sharpness=0.0,
            histogram=(),
            ring=None,
            problem=str(grab.reason),
        )
        return event, None
    image, ring, problem = grab.frame.image, None, ""
    try:
        ring = inspector.locate(image)
    except (LocateError, ModelError) as error:
        problem = inspector.view_problem(image) or str(error)
    measured = image if ring is None else unwrap(image, ring, um_per_px=inspector.um_per_px)
    quality = measure(measured)
    counts, _ = np.histogram(measured, BINS, (0, 256))
    event = SetupImageEvent(
        exposure_us=request.exposure_us,
        gain_db=request.gain_db,
        mean_dn=quality.mean_dn,
        saturated_share=quality.saturated_share,
        sharpness=quality.sharpness,
        histogram=tuple(int(count) for count in counts),
        ring=ring,
        problem=problem,
    )
    return event, make_preview(SETUP_IMAGE, image, ring, um_per_px=inspector.um_per_px)
