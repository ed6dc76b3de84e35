"""Session: a body of voxels that is dragged, fixed, cut, relaxed and solved, step by step."""
from __future__ import annotations

import os
from typing import Any, Dict, List, NamedTuple, Optional, Union

import numpy as np

from . import _supple
from ._errors import InputError
from ._supple import Grid
from ._volume import Progress, Volume, as_grid, as_volume
from ._warp import Warp, apply, metrics


class Report(dict):
    """Results of a step, run or plan, as JSON of the program has them: a dict of the values whose
    keys are attributes, too."""

    def __init__(self, values: Any = ()):
        super().__init__({key: _report(value) for key, value in dict(values or {}).items()})

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None


def _report(value: Any) -> Any:
    if isinstance(value, dict):
        return Report(value)
    return [_report(item) for item in value] if isinstance(value, list) else value


class Metrics(NamedTuple):
    """summary: dict of displacements in mm, det F, folds, volumes and bending. maps: read-only
    arrays [k, j, i] "jacobian" (1 outside the body), "length_mm", "bending_per_mm2", "folded"."""
    summary: Dict[str, Any]
    maps: Dict[str, np.ndarray]


def _box(place: Any) -> List[Any]:
    return np.asarray(place).tolist()


class Session:
    """Opens a volume at rest, or a state to continue.

    volume: path, Volume, image of nibabel, or a state file. material: name of materials(), path of
    a table, or a dict of its keys; by default one homogeneous tissue, with a warning, or that of
    the state. labels: volume of whole numbers on the same grid. tables: others of a scene, such as
    body=[{...}]. Raises InputError for what cannot be read or does not fit together.

    Keys of steps are those of a scene's [[step]] (docs/scenes.md); unknown ones raise InputError
    with the nearest known name. Every step can be undone. Threads may share a session: calls wait
    for each other.
    """

    def __init__(self, volume: Any, material: Any = None, *, labels: Any = None,
                 progress: Progress = None, **tables: Any):
        is_state = isinstance(volume, (str, os.PathLike)) and _supple.is_state(os.fspath(volume))
        self._volume = volume if is_state else as_volume(volume)
        source = {"path": os.fspath(volume)} if is_state else self._volume.source()
        root: Dict[str, Any] = {"volume": source}
        if material is not None:
            root["material"] = material_keys(material)
        if labels is not None:
            self._labels = as_volume(labels)
            root["labels"] = {"path": os.fspath(self._labels)}
        root.update(tables)
        self._held = _supple.HeldSession(root, progress)
        self._renderer: Any = None  # of its own pictures

    def event(self, kind: str, *, progress: Progress = None, **keys: Any) -> Optional[Report]:
        """One event of a live session (docs/live.md): grab, push, drag, release, cut, anchor,
        relax, limits, step, undo, redo, model, material; `keys` as there, by kind. Returns the
        report of the step that it became."""
        done = self._held.carry_out({"kind": kind, **keys}, progress)
        return None if done is None else Report(done)

    def step(self, *, progress: Progress = None, **keys: Any) -> Report:
        """One step with the `keys` of a scene's [[step]], and its report. Nothing has changed where
        it raises."""
        return self.event("step", progress=progress, **keys) or Report()

    def drag(self, grab: Any = None, by: Any = None, *, progress: Progress = None,
             **keys: Any) -> Report:
        """Drags the voxel `grab` (i, j, k) `by` mm along the grid axes; by_mm_lps, at_mm,
        grab_ball, soft and all other `keys` of a handle may take their places."""
        if grab is not None:
            keys["grab"] = _box(grab)
        if by is not None:
            keys["by"] = _box(by)
        return self.step(progress=progress, **keys)

    def fix(self, *places: Any, progress: Progress = None, **keys: Any) -> Report:
        """Fixes places: voxels [i, j, k] or boxes [i0, j0, k0, i1, j1, k1]; or keys of a step:
        fix_label, anchors."""
        if places:
            keys["fix"] = [_box(place) for place in places]
        return self.step(progress=progress, **keys)

    def cut(self, *, progress: Progress = None, **surface: Any) -> Report:
        """Cuts along a surface: mesh=path, plane={...}, curve={...} (points in LPS mm) or
        label=n."""
        return self.step(progress=progress, cut=[surface])

    def relax(self, *, progress: Progress = None, **settings: Any) -> Report:
        """Relaxes tissue; dragged elements stay held. settings: keys of `relax`, such as passes."""
        return self.step(progress=progress, relax=settings)

    def fem(self, settings: Optional[Dict[str, Any]] = None, *, progress: Progress = None,
            **keys: Any) -> Report:
        """Equilibrium of finite elements; `settings`: keys of `fem`; `keys`: of the step."""
        return self.step(progress=progress, model="fem", fem=settings or {}, **keys)

    def release(self, *, progress: Progress = None) -> Report:
        """Lets go of everything that is held or fixed."""
        return self.step(progress=progress, release=True)

    def undo(self, *, all: bool = False, progress: Progress = None) -> bool:  # noqa: A002
        """Takes a step back, bit for bit; all: those of one stroke. False where there is none."""
        return self._back_or_forth("undo", all, progress)

    def redo(self, *, all: bool = False, progress: Progress = None) -> bool:  # noqa: A002
        """Makes the step again that was taken back last; all: those of its stroke. False where
        there is none."""
        return self._back_or_forth("redo", all, progress)

    def _back_or_forth(self, kind: str, whole: bool, progress: Progress) -> bool:
        before = len(self.history[0])
        self.event(kind, progress=progress, **({"all": True} if whole else {}))
        return len(self.history[0]) != before

    @property
    def grid(self) -> Grid:
        """The grid of the volume."""
        return self._held.grid

    @property
    def hash(self) -> str:
        """SHA-256 of the body, equal for equal bodies, as `supple replay --json` has it."""
        return self._held.hash(None)

    @property
    def elements(self) -> int:
        """Number of voxels of the body."""
        return self._held.facts(None)["elements"]

    @property
    def reports(self) -> List[Report]:
        """Reports of all steps so far."""
        return [Report(report) for report in self._held.facts(None)["reports"]]

    @property
    def messages(self) -> List[str]:
        """Warnings since the session was opened."""
        return self._held.facts(None)["messages"]

    @property
    def history(self) -> tuple:
        """Texts of the strokes that are done, and of those that are undone."""
        facts = self._held.facts(None)
        return facts["done"], facts["undone"]

    @property
    def certificate(self) -> Report:
        """Worst cases of the inversion: residual in voxels, folded cells, smallest det F."""
        return Report(self._held.certificate(None))

    def displacement(self, *, progress: Progress = None) -> Warp:
        """Material direction on the volume's grid: voxel X is now at X + u(X); 0 in the void."""
        return Warp(self._held.displacement(progress), self.grid, direction="material")

    def offsets(self, *, void: str = "nearest", grid: Any = None,
                progress: Progress = None) -> Warp:
        """Resample direction with certificate: content at x came from x + o(x). void: what places
        without material hold: "nearest", "outside" or "extend" (docs/offsets.md). grid: Grid or
        volume on which they are, by default the session's."""
        on = self.grid if grid is None else as_grid(grid)
        return Warp(self._held.offsets(on, void, progress), on, direction="resample",
                    certificate=dict(self._held.certificate(progress)))

    def resample(self, *, grid: Any = None, interpolation: str = "linear",
                 progress: Progress = None) -> Volume:
        """The deformed volume on its own `grid` or another, in the type of the source; void reads
        its background. interpolation: "linear" or "cubic"."""
        if interpolation not in ("linear", "cubic"):
            raise InputError(f"interpolation: found {interpolation!r}, expected 'linear' or "
                             "'cubic'", field="interpolation")
        on = self.grid if grid is None else as_grid(grid)
        return Volume(self._held.resample(on, interpolation == "cubic", progress), on,
                      name="deformed")

    def metrics(self, *, maps: bool = True, progress: Progress = None) -> Metrics:
        """Displacement, det F, folds, change of volume and bending at rest, with maps unless
        False; see Metrics."""
        return metrics(self, maps=maps, progress=progress)

    def apply(self, **what: Any) -> Any:
        """Points or labels follow the body; see supple.apply() for `what` may be said."""
        return apply(self, **what)

    def show(self, **view: Any) -> Any:
        """Picture of the body; view: the arguments of supple.show()."""
        from ._scene import show
        return show(self, **view)

    def _repr_png_(self) -> bytes:
        return self.show(size=[512, 512]).png

    def save(self, path: Union[str, os.PathLike], *, progress: Progress = None) -> None:
        """Writes the state to a path (.vdb), which Session and the program continue."""
        self._held.save(os.fspath(path), progress)

    def journal(self) -> Dict[str, Any]:
        """The events as a journal, which `supple replay` brings to the same state."""
        return self._held.journal(None)

    def scene(self) -> Dict[str, Any]:
        """The steps as a scene, which Scene and `supple run` bring to the same state."""
        return self._held.scene(None)

    def __repr__(self) -> str:
        return f"Session({self.elements} elements, {len(self.history[0])} steps, {self.grid!r})"


def material_keys(material: Any) -> Dict[str, Any]:
    """The table [material] of a scene for a name, a path or keys."""
    if isinstance(material, dict):
        return material
    name = os.fspath(material)
    return {"preset": name} if name in _supple.materials() else {"table": name}
