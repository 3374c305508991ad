"""Mutation testing: does a test of the package notice each small fault in it?

Each mutant runs the tests of its own package only (tests/companion/<package>/, or `TESTED_IN`), in a forked
process, until the first one fails. The working tree is never written to. Within a function, the fault is put
into the functions of a process that has collected the tests already, and only the tests that call the
function run. A fault outside of functions is imported in a process of its own. Of planning, the twins in
Python are tested.

    python tests/mutation                       200 mutants, spread over all packages
    python tests/mutation --package control --sample 0        all mutants of one package

A mutant that behaves like the original is declared in equivalent.toml, with the reason.
"""

import argparse
import builtins
import contextlib
import functools
import gc
import importlib.abc
import importlib.util
import inspect
import os
import pickle
import random
import resource
import signal
import sys
import time
import tomllib
import traceback
from collections.abc import Callable, Collection, Iterable, Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import hypothesis
import numpy as np  # noqa: F401 — once for all mutants
import pytest
from mutants import Mutant, compiled, mutants_of, recording

ROOT = Path(__file__).parents[2]
# Of the boat, below companion/. --package takes any other folder with tests, too, such as sitl/world
PACKAGES = (
    "control", "estimation", "guidance", "failsafe", "geofence", "obstacles", "vehicle", "planning",
    "payload", "rc", "router", "sensors", "hal", "persistence", "services", "links", "log", "config",
    "calibration",
)  # fmt: skip
TESTED_IN = {  # where it is not tests/companion/<package> alone
    "hal": ("tests/hardware",),
    "planning": (
        "tests/companion/planning", "tests/companion/geofence/test_fence_areas.py",
        "tests/companion/geofence/test_fence_water.py", "tests/mission_tools/planning/test_exact_routes.py",
    ),
    "mavlink": (
        "tests/companion/mavlink", "tests/companion/services/ftp", "tests/protocol/test_mission_items.py",
        "tests/protocol/test_ftp_client.py", "tests/protocol/test_requests_per_item.py",
        "tests/protocol/test_transfer_back_to_back.py",
        "tests/protocol/test_transfer_rules.py", "tests/companion/vehicle/mission/test_mission_parts.py",
    ),
    "config": (
        "tests/companion/config", "tests/companion/app/init", "tests/companion/app/test_needs.py",
        "tests/companion/app/doctor/test_settings.py", "tests/companion/rc", "tests/hardware/pulses",
        "tests/companion/services/test_parameters_service.py", "tests/companion/services/ftp",
    ),
    "autopilot": (
        "tests/companion/autopilot", "tests/companion/app/test_missing_parts.py",
        "tests/companion/sensors/test_silent_sensors.py",
    ),
    "services/ftp": ("tests/companion/services/ftp", "tests/protocol/test_ftp_client.py"),
    "services": (
        "tests/companion/services", "tests/closed_loop/test_calibration_compass.py",
        "tests/closed_loop/test_calibration_heading.py", "tests/closed_loop/test_calibration_thrusters.py",
        "tests/closed_loop/test_calibration_stop.py",
        "tests/companion/vehicle/mission/test_mission_parts.py",
        "tests/companion/router/test_forgeable_addresses.py",
    ),
    "sensors": (
        "tests/companion/sensors", "tests/hardware/gnss", "tests/hardware/heading", "tests/hardware/water",
        "tests/companion/services/test_external_pose.py",
        "tests/companion/services/test_corrections.py",
    ),
    "log": (
        "tests/companion/log", "tests/companion/services/test_log_service.py",
        "tests/sitl/run/test_log_replay.py",
    ),
    "vehicle": (
        "tests/companion/vehicle", "tests/companion/geofence/test_surroundings.py",
        "tests/companion/failsafe/test_failsafes.py", "tests/companion/payload/test_control.py",
        "tests/companion/services/missions/test_list_ids.py",
    ),
    "mission_tools/assembly": (
        "tests/mission_tools/assembly", "tests/mission_tools/cli", "tests/mission_tools/test_python_face.py",
        "tests/mission_tools/costs/test_zones.py", "tests/mission_tools/costs/test_planned_currents.py",
        "tests/mission_tools/mission/test_plan_check.py",
    ),
    "mission_tools/costs": (
        "tests/mission_tools/costs", "tests/mission_tools/contract/test_budget.py",
        "tests/mission_tools/cli/test_task_options.py",
    ),
    "mission_tools/station": (
        "tests/mission_tools/station", "tests/protocol/test_ftp_client.py",
        "tests/mission_tools/shore/web/test_logs.py",
    ),
    "sitl/world": ("tests/sitl/world", "tests/sitl/scenarios/test_scenario_files.py"),
    "sitl/run": ("tests/sitl/run", "tests/sitl/radio/test_links_over_the_air.py"),
    "mission_tools/maps": (
        "tests/mission_tools/maps", "tests/mission_tools/mission/test_hostile_files.py",
        "tests/mission_tools/planning/test_fenced_planning.py", "tests/mission_tools/tracing",
    ),
}  # fmt: skip
SEED = 20261122
EXAMPLES = 25  # of Hypothesis for each property
CHEAP_CPU_S = 15.0  # of tests that do not call the file: against faults of declarations
SPARE_CPU_S = 10.0  # beyond twice what a test takes without a fault: a loop that does not end is killed
OPTIONS = (
    "-q", "-x", "--no-header", "-p", "no:cacheprovider", "-p", "no:xdist",
    "-W", "ignore::pytest.PytestAssertRewriteWarning",  # Hypothesis is imported once for all mutants
)  # fmt: skip
IDLE_S = 120.0  # without any processor time: a test that waits for what a fault keeps away is ended
POLL_S = 0.02
KILLED, SURVIVED = 1, 0
RECORDER = "record_call_of_mutation_baseline"  # among the builtins

Key = tuple[str, int]  # a function: file and first line


class Baseline:
    """calls: the tests that call each function, by number as collected. cpu_s: what each test takes."""

    def __init__(self) -> None:
        self.calls: dict[Key, set[int]] = {}
        self.cpu_s: list[float] = []
        self.ids: list[str] = []
        self.failed: list[str] = []


class Session:
    """A pytest plugin that runs the collected tests against mutants in place of the usual loop."""

    def __init__(self, package: str, run: Callable[[list[pytest.Item], pytest.Session], None]) -> None:
        self._package, self._run = package, run

    def pytest_configure(self) -> None:
        hypothesis.settings.register_profile(
            "mutation",
            max_examples=EXAMPLES,
            deadline=None,
            database=None,
            derandomize=True,
            phases=(hypothesis.Phase.explicit, hypothesis.Phase.generate),
            suppress_health_check=list(hypothesis.HealthCheck),
        )
        hypothesis.settings.load_profile("mutation")

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self._run(session.items, session)
        return True


def run_tests(items: Sequence[pytest.Item], session: pytest.Session, base: Baseline) -> int:
    """KILLED at the first test that fails, or the process is killed in one that does not end."""
    cpu_s = dict(zip(base.ids, base.cpu_s, strict=True))
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    for at, item in enumerate(items):
        following = items[at + 1] if at + 1 < len(items) else None
        limit_s = time.process_time() + 2.0 * cpu_s.get(item.nodeid, 0.0) + SPARE_CPU_S
        resource.setrlimit(resource.RLIMIT_CPU, (min(int(limit_s) + 1, hard), hard))
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        if session.testsfailed:
            return KILLED
    return SURVIVED


def measure(items: Sequence[pytest.Item], session: pytest.Session, paths: Iterable[str]) -> Baseline:
    """Run every test once, without a fault. paths: of the files whose calls are recorded.

    What functools caches is called anew by each test, or its faults were tried on the first test alone.
    """
    found, caches, modules = Baseline(), list[Any](), 0
    seen: set[Key] = set()
    setattr(builtins, RECORDER, seen.add)
    put_in_all([recording(ROOT, path, RECORDER) for path in paths])
    for number, item in enumerate(items):
        if len(sys.modules) != modules:
            caches, modules = caches_of_ours(), len(sys.modules)
        for cached in caches:
            cached.cache_clear()
        seen.clear()
        before, failed = time.process_time(), session.testsfailed
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
        found.cpu_s.append(time.process_time() - before)
        found.ids.append(item.nodeid)
        if session.testsfailed > failed:
            found.failed.append(item.nodeid)
            continue
        for key in seen:
            found.calls.setdefault(key, set()).add(number)
    return found


def caches_of_ours() -> list[Any]:
    """The functions of ours that functools caches."""
    kind, ours = type(functools.cache(len)), f"{ROOT}/"
    found = []
    for one in gc.get_objects():
        if isinstance(one, kind) and isinstance(of := inspect.unwrap(one), FunctionType):
            path = of.__code__.co_filename
            if path.startswith(ours) and "site-packages" not in path:
                found.append(one)
    return found


def put_in_all(codes: Iterable[CodeType]) -> None:
    """Give all functions of these modules their code from here."""
    by_place: dict[tuple[str, int, str], CodeType] = {}
    pending = list(codes)
    while pending:
        inner = [const for const in pending.pop().co_consts if isinstance(const, CodeType)]
        by_place |= {(one.co_filename, one.co_firstlineno, one.co_qualname): one for one in inner}
        pending += inner
    gc.unfreeze()  # or what was made during collection is not among the objects
    for live in gc.get_objects():
        if isinstance(live, FunctionType):
            old = live.__code__
            new = by_place.get((old.co_filename, old.co_firstlineno, old.co_qualname))
            if new is not None and new.co_freevars == old.co_freevars:
                live.__code__ = new


def put_in(code: CodeType, first_line: int) -> None:
    """Give the functions that begin at this line of the module their code from the mutated module."""
    pending, changed = [code], None
    while pending and changed is None:
        one = pending.pop()
        inner = [const for const in one.co_consts if isinstance(const, CodeType)]
        changed = next((const for const in inner if const.co_firstlineno == first_line), None)
        pending += inner
    if changed is None:
        raise LookupError(f"no function at line {first_line}")
    gc.unfreeze()
    for live in gc.get_objects():
        if isinstance(live, FunctionType):
            old = live.__code__
            if (old.co_filename, old.co_firstlineno) == (code.co_filename, first_line):
                live.__code__ = changed


class MutatedModule(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports one module from the code given."""

    def __init__(self, name: str, code: CodeType) -> None:
        self._name, self._code = name, code

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != self._name:
            return None
        return importlib.util.spec_from_file_location(fullname, self._code.co_filename, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        exec(self._code, module.__dict__)  # noqa: S102 — our own source


def fork(work: Callable[[], int], cpu_s: float, *, is_told: bool = False) -> int:
    """Run in a child, with so much processor time. is_told: errors are shown. Returns its process id."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    code = KILLED
    try:
        null = os.open(os.devnull, os.O_RDWR)
        for descriptor in (0, 1) if is_told else (0, 1, 2):
            os.dup2(null, descriptor)
        resource.setrlimit(resource.RLIMIT_CPU, (int(cpu_s) + 1, int(cpu_s) + 2))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.alarm(0)
        code = work()
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def run_all(jobs: Sequence[tuple[Mutant, Callable[[], int]]], cpu_s: float, cores: int) -> set[Mutant]:
    """Run each job in a child, as many at once as there are cores. Returns the mutants that survived."""
    running: dict[int, Mutant] = {}
    survived = set()
    pending = list(jobs)
    while pending or running:
        while pending and len(running) < cores:
            mutant, work = pending.pop(0)
            running[fork(work, cpu_s)] = mutant
        child, status = ended(running)
        mutant = running.pop(child)
        if status == SURVIVED:
            survived.add(mutant)
    return survived


def ended(children: Collection[int]) -> tuple[int, int]:
    """Wait for one of these processes; one that has used no processor time for IDLE_S is killed."""
    used: dict[int, list[str]] = {}
    looked_s = time.monotonic()
    while True:
        for child in children:
            found, status = os.waitpid(child, os.WNOHANG)
            if found:
                return child, status
        time.sleep(POLL_S)
        if time.monotonic() - looked_s < IDLE_S:
            continue
        now = {child: Path(f"/proc/{child}/stat").read_text().split()[-39:-37] for child in children}
        for child in children:
            if used.get(child) == now[child]:
                os.kill(child, signal.SIGKILL)
        used, looked_s = now, time.monotonic()


def in_child(work: Callable[[], object]) -> object:
    """What the work returns, done in a process of its own."""
    read, write = os.pipe()

    def send() -> int:
        with os.fdopen(write, "wb") as pipe:
            pickle.dump(work(), pipe)
        return 0

    child = fork(send, 3600.0, is_told=True)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        result: object = pickle.load(pipe)  # noqa: S301 — from our own child
    os.waitpid(child, 0)
    return result


def survivors(package: str, mutants: Sequence[Mutant], cores: int) -> tuple[set[Mutant], Baseline]:
    """The mutants of one package that its tests do not notice."""
    tests = TESTED_IN.get(package, (f"tests/{folder_of(package)}",))
    survived: set[Mutant] = set()
    base = Baseline()

    def run(items: list[pytest.Item], session: pytest.Session) -> None:
        nonlocal base
        for name in {module_of(mutant) for mutant in mutants}:  # the tests may import it late
            with contextlib.suppress(ImportError):
                importlib.import_module(name)
        paths = sorted({mutant.path for mutant in mutants})
        measured = in_child(lambda: measure(items, session, paths))
        assert isinstance(measured, Baseline)
        base = measured
        jobs: list[tuple[Mutant, Callable[[], int]]] = []
        for mutant in mutants:
            if callers := _callers(mutant, base):
                chosen = [items[at] for at in sorted(callers, key=lambda at: base.cpu_s[at])]
                jobs.append((mutant, _within(mutant, chosen, session, base)))
        survived.update(run_all(jobs, 2.0 * sum(base.cpu_s) + SPARE_CPU_S, cores))

    def whole() -> tuple[set[Mutant], Baseline]:
        pytest.main([*tests, *OPTIONS], plugins=[Session(package, run)])
        return survived, base

    survived, base = in_child(whole)  # type: ignore[misc]  # this process imports nothing of ours
    if not base.ids:
        raise SystemExit(f"no tests of {package} were collected")
    for test in base.failed:
        print("left out, it fails without a fault:", test)
    outside = [mutant for mutant in mutants if not _callers(mutant, base)]  # or called at import only
    jobs = [(mutant, _imported(package, mutant, base)) for mutant in outside]
    return survived | run_all(jobs, 2.0 * sum(base.cpu_s) + SPARE_CPU_S, cores), base


def module_of(mutant: Mutant) -> str:
    """Its name, as it is imported."""
    return mutant.path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def _callers(mutant: Mutant, base: Baseline) -> set[int]:
    """The tests that call the function with the fault. Empty for a fault outside of functions."""
    return base.calls.get((str(ROOT / mutant.path), mutant.first_line), set())


def _tests_of(mutant: Mutant, base: Baseline) -> list[str]:
    """The tests that call any function of the mutant's file, then as many cheap ones as take CHEAP_CPU_S."""
    path = str(ROOT / mutant.path)
    callers = {at for (name, _), tests in base.calls.items() if name == path for at in tests}
    chosen = sorted(callers, key=lambda at: base.cpu_s[at])
    others, left_s = sorted(set(range(len(base.ids))) - callers, key=lambda at: base.cpu_s[at]), CHEAP_CPU_S
    while others and (left_s := left_s - base.cpu_s[others[0]]) >= 0.0:
        chosen.append(others.pop(0))
    return [base.ids[at] for at in chosen]


def _within(
    mutant: Mutant, items: Sequence[pytest.Item], session: pytest.Session, base: Baseline
) -> Callable[[], int]:
    def work() -> int:
        put_in(compiled(ROOT, mutant), mutant.first_line)
        return run_tests(items, session, base)

    return work


def _imported(package: str, mutant: Mutant, base: Baseline) -> Callable[[], int]:
    def work() -> int:
        sys.meta_path.insert(0, MutatedModule(module_of(mutant), compiled(ROOT, mutant)))
        outcome = [KILLED]

        def run(items: list[pytest.Item], session: pytest.Session) -> None:
            outcome[0] = KILLED if session.testsfailed else run_tests(items, session, base)

        tests = _tests_of(mutant, base) or base.ids
        pytest.main([*tests, *OPTIONS], plugins=[Session(package, run)])
        return outcome[0]

    return work


def sample(mutants: Sequence[Mutant], count: int, seed: int) -> list[Mutant]:
    """So many of them, the same for the same seed; all for 0."""
    if not count or count >= len(mutants):
        return list(mutants)
    return random.Random(seed).sample(list(mutants), count)


def equivalents(path: Path) -> dict[tuple[str, str, str, str], str]:
    """The reasons for mutants that behave like the original, by file, function, before and after."""
    table = tomllib.loads(path.read_text())
    return {(one["path"], one["name"], one["before"], one["after"]): one["reason"] for one in table["mutant"]}


def folder_of(package: str) -> str:
    """Where its sources are, and its tests in tests/."""
    folder = f"companion/{package}" if (ROOT / "companion" / package).is_dir() else package
    has_tests = package in TESTED_IN or (ROOT / "tests" / folder).is_dir()
    if not ((ROOT / folder).is_dir() and has_tests):
        raise SystemExit(f"{package}: expected a package with tests, such as services/ftp or sitl/world")
    return folder


def mutants_in(package: str) -> list[Mutant]:
    """All mutants of a package."""
    files = sorted((ROOT / folder_of(package)).rglob("*.py"))
    return [one for file in files for one in mutants_of(ROOT, str(file.relative_to(ROOT)))]


def main(arguments: Iterable[str]) -> int:
    """Print the table; 1 if a package falls short."""
    parser = argparse.ArgumentParser(description="Mutation testing")
    parser.add_argument("--package", action="append", help="those of the boat unless given")
    parser.add_argument("--file", default="", help="only mutants of files whose path contains this text")
    parser.add_argument("--sample", type=int, default=200, help="mutants in all packages; 0: every mutant")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--least", type=float, default=0.0, help="percent of mutants that have to die")
    options = parser.parse_args(list(arguments))
    os.chdir(ROOT)
    os.environ["MAVBOAT_PURE"] = "1"
    sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
    known = equivalents(Path(__file__).parent / "equivalent.toml")
    packages = options.package or PACKAGES
    rows, falls_short, began_s = [], False, time.monotonic()
    for number, package in enumerate(packages):
        share = (options.sample + number) // len(packages) if options.sample else 0
        chosen = [one for one in mutants_in(package) if options.file in one.path]
        chosen = sample(chosen, share, options.seed)
        alike = {one for one in chosen if (one.path, one.name, one.before, one.after) in known}
        alive, base = survivors(package, [one for one in chosen if one not in alike], options.cores)
        for mutant in sorted(alive, key=lambda one: (one.path, one.line)):
            print("survived", mutant.text)
        counted = len(chosen) - len(alike)
        percent = 100.0 * (counted - len(alive)) / counted if counted else 100.0
        falls_short |= percent < options.least
        cells = (len(chosen), len(alike), counted - len(alive), len(alive))
        rows.append(f"{package:20}" + "".join(f"{cell:12}" for cell in cells) + f"{percent:8.0f} %")
        rows[-1] += f"{sum(base.cpu_s):10.1f} s"
    print(f"\nseed {options.seed}, {time.monotonic() - began_s:.0f} s")
    heads = ("mutants", "equivalent", "killed", "survived")
    print(f"{'package':20}" + "".join(f"{head:>12}" for head in heads) + f"{'share':>10}{'tests':>12}")
    print("\n".join(rows))
    return int(falls_short)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
