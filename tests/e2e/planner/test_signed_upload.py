"""`mission-upload --sign-key` against a vehicle that is pymavlink's own signing, in this process."""

import json
from pathlib import Path

import pytest
from fake_vehicle import Behaviour, fake_vehicle, link, zigzag_plan

from companion.mavlink.signing_key import SigningKey
from mission_tools.cli.upload import run_program

pytestmark = pytest.mark.realtime

KEY = SigningKey.from_passphrase("correct horse").reveal()


def key_file(folder: Path, passphrase: str = "correct horse") -> str:  # noqa: S107 - of a test
    path = folder / "boat.key"
    path.write_text(passphrase + "\n")
    path.chmod(0o600)
    return str(path)


def test_a_signed_mission_is_uploaded_started_and_followed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with fake_vehicle(Behaviour(sign_key=KEY)) as vehicle:
        options = ["--sign-key", key_file(tmp_path), "--start", "--follow", "--json"]
        assert run_program([zigzag_plan(tmp_path), *link(vehicle, 60), *options]) == 0
        parser = vehicle._parser
        assert parser.signing.goodsig_count > 10
        assert parser.signing.badsig_count == parser.signing.reject_count == 0
    report = json.loads(capsys.readouterr().out)
    assert report["upload"]["items"] == len(vehicle.mission) == 7
    assert report["upload"]["read_back_equal"]


@pytest.mark.parametrize(
    ("passphrase", "vehicle_key", "told"),
    [
        ("battery staple", KEY, "what it says is signed with another key"),
        ("correct horse", None, "what it says is not signed: give the boat the same key"),
    ],
)
def test_keys_that_do_not_fit_are_told_with_3(
    tmp_path: Path, passphrase: str, vehicle_key: bytes | None, told: str,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    with fake_vehicle(Behaviour(sign_key=vehicle_key)) as vehicle:
        options = ["--sign-key", key_file(tmp_path, passphrase)]
        assert run_program([zigzag_plan(tmp_path), *link(vehicle, 5), *options]) == 3
    assert told in capsys.readouterr().err
    assert vehicle.mission == []
