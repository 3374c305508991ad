"""The rollouts of a boat before a rock."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.cost import HORIZON_S, HULL, TOUCH, CostModel
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.motion import CourseFan, Rollout
from pictures.svg import Drawing

_CONFIG: Final = BoatConfig()
_SCALE: Final = 60.0  # pixels a metre
_GOOD, _BAD, _BEST = (46, 134, 71), (200, 60, 50), "#1f4fa3"


def draw_rollouts() -> str:
    """The fan of a boat at 1 m/s, bow up, with a rock ahead."""
    rock = [Point(3.0 + 0.2 * n, 0.3 + 0.2 * e) for n in range(4) for e in range(-3, 4)]
    nav, fan = _nav(0.0, 0.0, 0.0, 1.0), CourseFan()
    costs = _costs(nav, _field(nav, rock))
    best = costs.choose(fan, 1.0, None, None, is_certain=True, is_new=False)
    rated = []
    for speed in (1.0, 0.6, 0.4):
        for one in fan.rollouts(1.0, 0.0, speed, _CONFIG):
            rated.append((costs.plain(one, None) + costs.risk(one), one))
    least = min(cost for cost, _ in rated)
    drawing = Drawing()
    for cost, one in sorted(rated, key=lambda each: -each[0]):
        share = min((cost - least) / 3.0, 1.0)
        shade = "#" + "".join(f"{round(g + share * (b - g)):02x}" for g, b in zip(_GOOD, _BAD, strict=True))
        drawing.line(*_pixels(one), colour=shade, width=1.2)
    for at in rock:
        x, y = _pixel(at.north_m, at.east_m)
        drawing.box(x - 0.1 * _SCALE, y - 0.1 * _SCALE, 0.2 * _SCALE, 0.2 * _SCALE, "#777777")
    if best is not None:
        drawing.line(*_pixels(best), colour=_BEST, width=4.0)
    drawing.dot(*_pixel(0.0, 0.0), _BEST, 6.0)
    drawing.write(20.0, 20.0, "green: cheap, red: expensive, blue: the one that is held, grey: rock")
    drawing.scale_bar(20.0, 460.0, _SCALE)
    return drawing.text(640.0, 480.0, "Rollouts before a rock")


def _nav(north_m: float, east_m: float, heading_rad: float, surge_m_s: float) -> NavState:
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    return NavState(
        0.0, north_m, east_m, heading_rad, 0.0, surge_m_s * c, surge_m_s * s, surge_m_s, 0.0, 0.0, 0.0
    )


def _field(nav: NavState, rock: list[Point]) -> ClearanceField:
    field = ClearanceField(nav.point, 0.2, 9.0)
    field.fill(rock, rock, TOUCH)
    return field


def _costs(nav: NavState, field: ClearanceField) -> CostModel:
    margin_m = _CONFIG.avoidance.margin_m
    to_go = CostToGo(field, nav.point, Point(50.0, 0.0), margin_m, HULL * margin_m)
    return CostModel(nav, field, to_go, [], margin_m, HORIZON_S, 0.0, _CONFIG)


def _pixel(north_m: float, east_m: float) -> tuple[float, float]:
    return 320.0 + _SCALE * east_m, 420.0 - _SCALE * north_m


def _pixels(rollout: Rollout) -> list[tuple[float, float]]:
    places = zip((0.0, *rollout.ahead_m), (0.0, *rollout.right_m), strict=True)
    return [_pixel(ahead, right) for ahead, right in places]
