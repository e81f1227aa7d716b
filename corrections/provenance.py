"""What the provenance of a baked clip tells about its corrections.

Provenance is not validated when a clip is read: any value may be missing or malformed.
"""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from msgspec import ValidationError, convert
from numpy.typing import NDArray

from corrections import Correction
from gclip import Clip


def baked_corrections(clip: Clip) -> tuple[Correction, ...]:
    """The corrections that a clip was baked with; none if its provenance lists none."""
    with suppress(LookupError, TypeError, ValidationError):
        return convert(clip.provenance["options"]["corrections"], tuple[Correction, ...])
    return ()


def file_to_local(clip: Clip, scan: str) -> NDArray[np.float64]:
    """The transform from the coordinates of a scan's file to the clip's local coordinates.

    Parameters
    ----------
    clip : gclip.Clip
    scan : str
        Name of the scan in the clip.

    Returns
    -------
    (4, 4) float64 ndarray
        For column vectors. A translation if the provenance does not tell the transform.
    """
    provenance = clip.provenance
    malformed = (LookupError, TypeError, ValueError, OverflowError)
    with suppress(*malformed), np.errstate(all="ignore"):
        index = [entry["name"] for entry in provenance["inputs"]].index(scan)
        origin = provenance["origins"][index] if "origins" in provenance else clip.origin
        transform = np.array(provenance["transforms"][index], float).reshape(4, 4)
        transform = transform @ _translation_from(origin)
        transform[:, :3] *= float(provenance["options"]["scale"])
        if np.isfinite(transform).all() and np.isfinite(np.linalg.inv(transform)).all():
            return transform
    return _translation_from(clip.origin)  # the clip was made by another program


def _translation_from(origin: Sequence[float]) -> NDArray[np.float64]:
    """(4, 4) transform to coordinates relative to an origin."""
    translation = np.eye(4)
    translation[:3, 3] -= origin
    return translation
