"""The filter's inside in the onboard log."""

import math
from pathlib import Path

import pytest
from boat_rig import waypoint
from log_rig import OpenRig, Record, of_kind, read_log

from companion.estimation.covariance import STATE_NAMES
from companion.estimation.estimator import EstimatorReport
from companion.estimation.innovation import GATE_2, Innovation
from companion.log import samples
from companion.log.records import HEADER

pytest_plugins = ("log_fixtures",)

_DEG = 180.0 / math.pi


def _report(**over: Innovation) -> EstimatorReport:
    state = tuple(0.1 * (number + 1) for number in range(len(STATE_NAMES)))
    variances = [(0.01 * (number + 1)) ** 2 for number in range(len(STATE_NAMES))]
    covariance = tuple(
        tuple(variance if row == column else 0.0 for column in range(len(variances)))
        for row, variance in enumerate(variances)
    )
    innovations = {
        name: Innovation(1.0, 0.1 * (number + 1), 0.04)
        for number, name in enumerate(
            ("position_north", "position_east", "velocity_north", "velocity_east", "compass", "gyro")
        )
    }
    hypotheses = (("compass wrong", 0.25), ("gyro wrong", 0.5), ("gnss wrong", 0.125))
    return EstimatorReport(state, covariance, **{**innovations, **over}, hypotheses=hypotheses)


def _logged(folder: Path, report: EstimatorReport) -> dict[str, Record]:
    path = folder / "a.bin"
    path.write_bytes(HEADER + b"".join(samples.estimator(1_000_000, report, 0.25)))
    return {record.get_type(): record for record in read_log(path)}


def test_innovations_and_ratios_are_in_ardupilots_records(tmp_path: Path) -> None:
    logged = _logged(tmp_path, _report())
    xkf3, xkf4 = logged["XKF3"], logged["XKF4"]
    assert pytest.approx((0.1, 0.2, 0.3, 0.4)) == (xkf3.IPN, xkf3.IPE, xkf3.IVN, xkf3.IVE)
    assert pytest.approx(0.5 * _DEG, abs=0.01) == xkf3.IYAW
    assert pytest.approx(math.sqrt((0.01 + 0.04) / 0.04 / GATE_2), abs=0.006) == xkf4.SP
    assert pytest.approx(math.sqrt((0.09 + 0.16) / 0.04 / GATE_2), abs=0.006) == xkf4.SV
    assert pytest.approx(2.0) == xkf4.SM  # 0.5 rad of 0.25


def test_large_innovations_are_limited_to_the_field(tmp_path: Path) -> None:
    far = Innovation(1.0, 5000.0, 0.04)
    logged = _logged(tmp_path, _report(position_north=far))
    assert pytest.approx(327.67) == logged["XKF3"].IPN
    assert pytest.approx(327.67) == logged["XKF4"].SP


def test_deviations_errors_and_hypotheses_have_their_units(tmp_path: Path) -> None:
    logged = _logged(tmp_path, _report())
    esd, ebia, ehyp = logged["ESD"], logged["EBIA"], logged["EHYP"]
    assert (esd.N, esd.E, esd.Su, esd.CN, esd.CE) == pytest.approx((0.01, 0.02, 0.04, 0.06, 0.07))
    assert (esd.Hd, esd.GB, esd.CO) == pytest.approx((0.03 * _DEG, 0.08 * _DEG, 0.09 * _DEG))
    assert pytest.approx((0.1, 0.11, 0.12)) == (esd.G, esd.RN, esd.RE)
    assert pytest.approx((0.8 * _DEG, 0.9 * _DEG)) == (ebia.GB, ebia.CO)
    assert (ebia.G, ebia.RN, ebia.RE, ebia.Dly) == pytest.approx((1.0, 1.1, 1.2, 1.3))
    assert (ehyp.Cmp, ehyp.Gyr, ehyp.Gns) == (0.25, 0.5, 0.125)


def test_the_inside_is_logged_five_times_a_second_at_most(open_rig: OpenRig, tmp_path: Path) -> None:
    rig = open_rig(tmp_path, "vehicle.log.motion_hz=50.0")
    rig.sail(waypoint(12, 0), waypoint(12, 9))
    rig.run(4.0)
    rig.disarm()
    times_us = [record.TimeUS for record in of_kind(read_log(tmp_path / "00001.bin"), "XKF3")]
    span_s = (times_us[-1] - times_us[0]) * 1e-6
    assert (len(times_us) - 1) / span_s == pytest.approx(5.0, rel=0.02)
