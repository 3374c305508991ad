"""A boat that sounds: its log gives the depths where they are, and says where there are none."""

import math
from pathlib import Path

import numpy as np
import pytest
from boat_rig import waypoint
from log_rig import LogRig
from sailing_rig import begin

from companion.core.geo import LatLon
from mission_tools.bathymetry.from_log import read_samples
from sitl.world.environment.bottom import Bathymetry

SETTINGS = (
    "sensors.depth.fitted=true", "sensors.depth.noise_m=0.005", "sensors.depth.noise_share=0.0",
    "sensors.depth.sound_gain=1.0", "sensors.depth.beam_deg=2", "sensors.depth.double_share=0.0",
    "sensors.depth.forward_m=-1.5", "sensors.depth.starboard_m=0.5", "sensors.depth.lost_share=0.0",
    "sensors.gnss.receiver=rtk", "sensors.gnss.noise_m=0.01", "sensors.gnss.wander_m=0.02",
    "environment.depth_m=8.0",
    "environment.bottom.kind=fractal", "environment.bottom.roughness_m=1.0",
)  # fmt: skip


def test_the_log_of_a_voyage_has_the_bottom_and_a_minute_without_a_sounder(tmp_path: Path) -> None:
    config: dict[str, object] = {"parts.depth.forward_m": -1.5, "parts.depth.starboard_m": 0.5}
    rig = LogRig(tmp_path, *SETTINGS, "seed=41", config=config).sail(waypoint(300.0, 40.0))
    rig.run(30.0)
    begin(rig, "depth", "off")
    rig.run(60.0)
    rig.world.electronics.faults.end("depth")
    rig.run(10.0)
    rig.boat.close()
    samples = read_samples(tmp_path / "00001.bin")
    found, truth = samples.soundings, Bathymetry(rig.scenario.chart, rig.scenario.environment)

    def error_m(ahead_m: float) -> float:
        """RMS, with the places moved ahead."""
        places = [
            rig.scenario.frame.to_local(LatLon(lat_deg, lon_deg)).moved(heading_rad, ahead_m)
            for lat_deg, lon_deg, heading_rad in zip(
                found.lat_deg, found.lon_deg, found.heading_rad, strict=True
            )
        ]
        off_m = found.depth_m + found.transducer_m - truth.depths_m(*np.array(places).T)
        return math.sqrt(np.mean(off_m**2))

    gaps_s = np.sort(np.diff(samples.sounded_s))
    assert len(found.depth_m) > 5 * 35
    assert gaps_s[-1] == pytest.approx(60.0, abs=0.5)
    assert gaps_s[-2] < 0.25
    assert error_m(0.0) < 0.06  # what the receiver errs by, on slopes of one in six
    assert min(error_m(1.5), error_m(-1.5)) > 2.0 * error_m(0.0)
