"""Supple: deform CT and MRI volumes without resampling them, with certificates.

Volumes are arrays ``[k, j, i]`` and vectors ``[k, j, i, 3]`` in millimetres of LPS (x to the
patient's left, y to posterior, z to superior). Affines take ``(i, j, k, 1)`` to LPS millimetres.
Every deformation names its direction: ``"resample"``, content at x came from x + o(x), or
``"material"``, voxel X is now at X + u(X). Arrays that are handed out are read-only and stay valid
without their owner. Long calls release the GIL, take ``progress=callback(stage, fraction)`` (one
that returns False cancels), and end by Ctrl-C.

    import supple
    session = supple.Session("head.nii.gz", material="ct-head")
    session.drag([128, 211, 12], [0, 12, 0])
    dragged = session.resample().array
    jacobian = session.metrics().maps["jacobian"]
"""
from ._errors import Cancelled, Error, InputError, SuppleWarning, SystemError, UsageError
from ._supple import Grid, version as __version__
from ._volume import Volume, open
from ._warp import (Points, Straight, Warp, apply, compose, fit, invert, metrics, read_warp,
                    resample, straighten)
from ._session import Metrics, Report, Session
from . import augment
from ._scene import Picture, Renderer, Scene, materials, models, presets, show
from . import live
from ._view import View, view

__all__ = [
    "Cancelled", "Error", "Grid", "InputError", "Metrics", "Picture", "Points", "Renderer",
    "Report", "Scene", "Session", "Straight", "SuppleWarning", "SystemError", "UsageError", "View",
    "Volume", "Warp", "apply", "augment", "compose", "fit", "invert", "live", "materials",
    "metrics", "models", "open", "presets", "read_warp", "resample", "show", "straighten", "view"]
