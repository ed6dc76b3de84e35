"""Strokes of a hand, place by place, as the viewer has them: every place with its picture, the
model that leads, the error that is left and the force in newtons."""
from __future__ import annotations

from typing import Any, Dict, Iterable, Iterator, NamedTuple, Optional

from ._scene import Picture, Renderer
from ._session import Report, Session
from ._volume import Progress

__all__ = ["Moment", "stroke"]


class Moment(NamedTuple):
    """A body in hand at one place of a stroke, or, with a `report`, after it.

    model: what the body follows: "ecm", or "fem" once elements under the hand have a level.
    picture: of the body so, or None. hand: what pages of the viewer are told: asked and reached, in
    mm along the grid axes from where it was grabbed; moved, elements; stopped_by, "held", "cut" or
    None; with elements under it level, edge_voxels, done. error_mm: 95th percentile of what is left
    beside the last level, None where it is not known. force_n: with which the body pulls at the
    handle, or None. report: of the step that the stroke became, after it.
    """
    model: str
    picture: Optional[Picture]
    hand: Report
    error_mm: Optional[float] = None
    force_n: Optional[float] = None
    report: Optional[Report] = None


def stroke(session: Session, targets: Iterable[Any], *, fem: Optional[Dict[str, Any]] = None,
           best: bool = False, pictures: bool = True, view: Optional[Dict[str, Any]] = None,
           renderer: Optional[Renderer] = None, progress: Progress = None,
           **grab: Any) -> Iterator[Moment]:
    """Grabs, leads the hand to one target after the other, and lets go; a Moment for each target
    and one after it.

    session: whose body it is. targets: mm along the grid axes from where it was grabbed, or dicts
    of the keys of a drag event (docs/live.md); each is asked for when the moment before it has been
    dealt with. fem: keys of `fem`, {} for none: finite elements under the hand
    (docs/live_elements.md) from now on. best: every moment waits until their last level leads.
    pictures: False draws none. view: keys of Renderer.render(); size is [512, 512] unless said.
    renderer: draws them, by default one of the stroke. grab: keys of a grab event: grab, grab_ball,
    radius, soft, directions, ...

    A loop that is left early lets go there. Where a move raises, the stroke is taken back. Raises
    InputError for keys and places that are none.
    """
    if fem is not None:
        session.event("model", model="fem", fem=fem, under_hand=True, progress=progress)
    if pictures and renderer is None:
        renderer = Renderer(session)
    look: Dict[str, Any] = {"size": [512, 512], **(view or {})}

    def moment(report: Optional[Report] = None) -> Moment:
        if best and report is None:
            session._held.wait_for_hand(progress)
        drawn = None
        if pictures and renderer is not None:
            drawn = renderer.render(progress=progress, **look)
        hand = Report(session._held.hand(progress))
        return Moment(hand.pop("model"), drawn, hand, hand.pop("error_mm", None),
                      hand.pop("force_n", None), report)

    session.event("grab", progress=progress, **grab)
    try:
        for target in targets:
            keys = target if isinstance(target, dict) else {"to": target}
            session.event("drag", progress=progress, **keys)
            yield moment()
    except GeneratorExit:
        session.event("release", progress=progress)
        raise
    except BaseException:
        session.event("release", restore=True)
        raise
    yield moment(session.event("release", progress=progress) or Report())
