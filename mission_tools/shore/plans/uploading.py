"""The request `upload_plan`: a plan of the desk becomes the boat's mission, as it is."""

from collections.abc import Callable

from msgspec import Struct, ValidationError, convert

from mission_tools.shore.plans.plan_service import PlanService
from mission_tools.station.boats import Boats
from mission_tools.station.messages import Answer, PageRequest
from mission_tools.station.outcome import Accepted, Outcome
from mission_tools.station.uploads import plan_upload
from mission_tools.station.words import say


class _Asked(Struct, frozen=True, forbid_unknown_fields=True):
    """with_areas: also the fence and the rally points of an imported plan."""

    plan: str
    start: bool = False
    with_areas: bool = False


def upload_stored_plan(
    boats: Boats, plans: PlanService, request: PageRequest, reply: Callable[[Answer], None]
) -> None:
    """Upload, read back and start if asked; `reply` is called once, minutes later for a long plan."""
    try:
        asked = convert(request.arguments, _Asked)
    except ValidationError:
        reply(Answer(id=request.id, ok=False, text=say("answer.plan_expected")))
        return
    kept = plans.store.find(asked.plan)
    if kept is None:
        reply(Answer(id=request.id, ok=False, text=say("answer.plan_gone")))
        return
    mission, fence, rally = kept.lists
    areas = (fence, rally) if asked.with_areas else ((), ())

    def answered(outcome: Outcome) -> None:
        snapshot = boats.snapshot(request.boat)
        ok, text = isinstance(outcome, Accepted), outcome.text
        if ok and asked.start and snapshot is not None and snapshot.armed is False:
            text = say("answer.when_armed", what=text)
        reply(Answer(id=request.id, ok=ok, text=text, result={"items": kept.plan.items} if ok else None))

    boats.upload(request.boat, plan_upload(mission, *areas, is_started=asked.start), answered)
