"""What is said below the result of a what-if."""

from station.analysis.what_if import WhatIf
from station.panel.look.words import translate


def notes(found: WhatIf, left_out: int) -> str:
    """Return what the counts of a what-if do not show; `left_out` parts could not be compared."""
    if not found.compared:
        return translate(
            "recipe", "The archive has no parts of this recipe, so the effect of the limits is unknown."
        )
    unknown = translate(
        "recipe", "{n} images of insufficient quality would now be judged; their verdict is unknown."
    )
    others = translate("recipe", "{n} parts were left out: judged by another model or not readable.")
    unlike = translate(
        "recipe",
        "{n} parts are unlike the training images: OK with model.novel = flag, not judged with error.",
    )
    counted = ((unknown, found.unknown), (others, left_out), (unlike, found.unlike))
    return " ".join(text.format(n=count) for text, count in counted if count)
