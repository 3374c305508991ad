"""Same seed, same bytes: in every process, whatever Python's own hashing does there, and in other Pythons.

Other interpreters, which must have the dependencies, are named by MAVBOAT_PYTHONS, separated by colons.
"""

import json
import os
import subprocess
import sys

import pytest
from patience import JOB_S

pytestmark = pytest.mark.slow

OTHERS = [name for name in os.environ.get("MAVBOAT_PYTHONS", "").split(":") if name]
ROUGH = ("environment.current_m_s=0.4", "environment.gust_m_s=8", "environment.wave_height_m=0.1")


def state_hash(python: str, hash_seed: str, *arguments: str) -> str:
    """Sail in a process of its own."""
    command = [python, "-m", "sitl", "sail", *arguments, "--json"]
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
    done = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, text=True, check=False, timeout=JOB_S
    )
    figures, _ = json.JSONDecoder().raw_decode(done.stdout)  # an error may follow
    told: str = figures["state_hash"]
    return told


def test_two_processes_sail_the_same_to_the_last_bit() -> None:
    arguments = ["open", "--course", "straight", "--seed", "5", "--timeout", "30"]
    for setting in ROUGH:
        arguments += ["--set", setting]
    first = state_hash(sys.executable, "1", *arguments)
    assert state_hash(sys.executable, "2", *arguments) == first


@pytest.mark.skipif(not OTHERS, reason="no other Python is named in MAVBOAT_PYTHONS")
@pytest.mark.parametrize("python", OTHERS or ["none"])
@pytest.mark.parametrize("scenario", ["pool", "random"])
def test_other_pythons_sail_the_same_to_the_last_bit(python: str, scenario: str) -> None:
    mine = state_hash(sys.executable, "1", scenario, "--seed", "7")
    assert state_hash(python, "1", scenario, "--seed", "7") == mine
