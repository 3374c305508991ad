"""The comparison of surveys with routes of other programs."""

from pathlib import Path

import pytest
import shapely

from benchmarks.planning.survey_beside import main

FIELD = ("lake", "30", "2")


@pytest.mark.slow
def test_the_shortest_route_counts_that_covers_as_much(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    field, dense, sparse = (tmp_path / f"{name}.wkt" for name in ("field", "dense", "sparse"))
    assert main([*FIELD, str(field)]) == 0
    water = shapely.from_wkt(field.read_text())
    assert 150_000.0 < water.area < 190_000.0
    west, south, east, north = water.bounds
    for path, spacing_m in ((dense, 29.0), (sparse, 40.0)):
        rows = [south + n * spacing_m for n in range(int((north - south) / spacing_m) + 2)]
        shuttle = [(x, y) for n, y in enumerate(rows) for x in ((west, east), (east, west))[n % 2]]
        path.write_text(shapely.LineString(shuttle).wkt)
    assert main([*FIELD, str(sparse), str(dense)]) == 0
    length_m = shapely.from_wkt(dense.read_text()).length
    said = capsys.readouterr().out
    assert f"other: {length_m:.0f} m, 100.00%" in said
    own_m = float(said.split("islands: ")[1].split(" m")[0])
    assert said.endswith(f"ratio {own_m / length_m:.3f}\n")
    assert main([*FIELD, str(sparse)]) == 0
    assert "other: nan m" in capsys.readouterr().out
