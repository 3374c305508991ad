"""Pictures: that they are drawn, at the promised size, and show what they are told to."""

import io
from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.figure import Figure

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.drawing.draw import draw_picture
from mission_tools.maps import Chart, Feature, build_chart, load_geojson
from mission_tools.planning.planner import plan

pytestmark = pytest.mark.slow

POND = Path(__file__).parents[3] / "examples" / "maps" / "mill_pond.geojson"
ORIGIN = LatLon(50.0, -1.2)
TRACK = [Point(-150.0, -194.0), Point(-100.0, -120.0), Point(0.0, 20.0), Point(232.0, 222.0)]


@pytest.fixture(scope="module")
def pond() -> Chart:
    return load_geojson(POND, ORIGIN)


def pixels(figure: Figure) -> "np.ndarray[tuple[int, ...], np.dtype[np.float32]]":
    """Red, green and blue from 0 to 1."""
    width, height = (figure.get_size_inches() * figure.dpi).round().astype(int)
    figure.savefig(drawn := io.BytesIO(), format="rgba")
    image = np.frombuffer(drawn.getvalue(), np.uint8).reshape(height, width, 4)
    return image[..., :3].astype(np.float32) / 255.0


def test_a_picture_has_1600_by_1200_pixels_and_what_is_added_shows(pond: Chart) -> None:
    found = plan(pond, TRACK[0], TRACK[-1]).points
    both = draw_picture(pond, found, TRACK, title="Mill Pond", subtitle="581 m", clearance_m=4.0)
    by_speed = draw_picture(pond, track=TRACK, speeds_m_s=[1.0, 2.0, 1.5, 0.0])
    images = [pixels(figure) for figure in (both, by_speed)]
    assert [image.shape[:2] for image in images] == [(1200, 1600)] * 2
    assert np.abs(images[0] - images[1]).max() > 0.1


def pool() -> Chart:
    """Of the paper's size; a box by its right wall, so that its name would be cut there."""
    box = Feature("Box by the wall", "obstacle", shapely.box(0.9, 0.88, 1.12, 1.0))
    return build_chart("Pool", LocalFrame(ORIGIN), shapely.box(-0.05, -0.05, 1.175, 2.45), [box])


def test_the_picture_of_a_narrow_pool_shows_pool_and_no_beach() -> None:
    image = pixels(draw_picture(pool(), [Point(0.2, 0.2), Point(2.2, 1.0)]))
    land = np.array([0xEF, 0xE6, 0xCF], dtype=np.float32) / 255.0
    assert float((np.abs(image - land).max(axis=2) < 0.02).mean()) < 0.15
    assert image.shape[0] == 1200
    assert image.shape[1] < 1100


def test_a_name_that_would_lie_over_another_is_left_out() -> None:
    posts = [
        Feature(f"Post {n}", "obstacle", shapely.box(east, 10.0, east + 1.0, 11.0))
        for n, east in enumerate((10.0, 11.5, 60.0))
    ]
    figure = draw_picture(build_chart("Posts", LocalFrame(ORIGIN), shapely.box(0.0, 0.0, 100.0, 80.0), posts))
    shown = {text.get_text() for text in figure.axes[0].texts if text.get_visible()}
    assert {"Post 0", "Post 2"} <= shown
    assert "Post 1" not in shown
