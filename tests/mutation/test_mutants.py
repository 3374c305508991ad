"""The mutants are those that the rules say, and each changes what the code does."""

import ast
import builtins
import importlib
import importlib.util
import threading
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from mutants import Mutant, compiled, mutants_of

SOURCE = '''"""A module."""

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    import decimal

LIMIT: Final = 2.0
NAMES = ("left", "right")


class Counter:
    """Counts."""

    __slots__ = ("count",)

    def __init__(self) -> None:
        self.count = 0

    def add(self, weight: float = 0.0) -> float:
        """Docstrings hold 3 numbers."""
        self.count += 1
        print(f"{weight:5.2f}")
        if not weight and self.count > 3:
            return min(weight, -LIMIT)
        return weight * 2


async def pair(one: int) -> tuple[int, int]:
    def inner() -> int:
        return one
    return inner(), 7
'''
FAULTS = {
    ("", "2.0", "4.0"),
    ("Counter.__init__", "self.count = 0", "pass"),
    ("Counter.__init__", "0", "1"),
    ("Counter.add", "0.0", "1.0"),
    ("Counter.add", "self.count += 1", "self.count -= 1"),
    ("Counter.add", "self.count += 1", "pass"),
    ("Counter.add", "1", "2"),
    ("Counter.add", "print(f'{weight:5.2f}')", "pass"),
    ("Counter.add", "not weight and self.count > 3", "not weight or self.count > 3"),
    ("Counter.add", "not weight", "weight"),
    ("Counter.add", "self.count > 3", "self.count <= 3"),
    ("Counter.add", "3", "4"),
    ("Counter.add", "return min(weight, -LIMIT)", "return None"),
    ("Counter.add", "min(weight, -LIMIT)", "max(weight, -LIMIT)"),
    ("Counter.add", "-LIMIT", "LIMIT"),
    ("Counter.add", "return weight * 2", "return None"),
    ("Counter.add", "weight * 2", "weight / 2"),
    ("Counter.add", "2", "3"),
    ("pair.inner", "return one", "return None"),
    ("pair", "return (inner(), 7)", "return (7, inner())"),
    ("pair", "7", "8"),
}


@pytest.fixture
def faults(tmp_path: Path) -> list[Mutant]:
    (tmp_path / "counter.py").write_text(SOURCE)
    return mutants_of(tmp_path, "counter.py")


def test_every_place_that_counts_has_its_faults_and_no_other(faults: list[Mutant]) -> None:
    assert {(one.name, one.before, one.after) for one in faults} == FAULTS
    assert len(faults) == len(FAULTS)


def test_a_mutant_is_the_source_with_that_one_fault(tmp_path: Path, faults: list[Mutant]) -> None:
    chosen = next(one for one in faults if one.before == "weight * 2")
    module: dict[str, object] = {}
    exec(compiled(tmp_path, chosen), module)  # noqa: S102
    counter = module["Counter"]
    assert isinstance(counter, type)
    assert counter().add(3.0) == 1.5
    assert module["LIMIT"] == 2.0


def test_all_mutants_compile_and_differ(tmp_path: Path, faults: list[Mutant]) -> None:
    codes = [compiled(tmp_path, one) for one in faults]
    assert len({repr(code.co_consts) + code.co_code.hex() for code in codes} | {"original"}) > 1
    original = ast.dump(ast.parse((tmp_path / "counter.py").read_text()))
    assert original == ast.dump(ast.parse(SOURCE)), "the file stays as it is"


def test_a_fault_knows_the_outermost_function_that_holds_it(faults: list[Mutant]) -> None:
    lines = SOURCE.splitlines()
    first = {one.before: lines[one.first_line - 1].strip() if one.first_line else "" for one in faults}
    assert first["return one"] == "async def pair(one: int) -> tuple[int, int]:"
    assert first["weight * 2"].startswith("def add")
    assert first["2.0"] == ""
    assert first["0.0"] == "", "a default is evaluated outside of its function"


@pytest.fixture
def program() -> ModuleType:
    spec = importlib.util.spec_from_file_location("program", Path(__file__).with_name("__main__.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_test_that_waits_for_ever_is_ended(
    faults: list[Mutant], program: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "IDLE_S", 0.3)

    def waits() -> int:
        threading.Event().wait()
        return 0

    assert program.run_all([(faults[0], waits), (faults[1], lambda: 0)], 60.0, 1) == {faults[1]}


def test_a_cached_call_is_recorded_for_each_test_that_makes_it(
    tmp_path: Path, program: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "cached.py").write_text("import functools\n\n@functools.cache\ndef one():\n    return 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(program, "ROOT", tmp_path)
    monkeypatch.setattr(builtins, program.RECORDER, None, raising=False)
    one = importlib.import_module("cached").one
    hook = SimpleNamespace(pytest_runtest_protocol=lambda **_: one())
    item = SimpleNamespace(config=SimpleNamespace(hook=hook), nodeid="test")
    found = program.measure([item, item], SimpleNamespace(testsfailed=0), ["cached.py"])
    assert found.calls == {(str(tmp_path / "cached.py"), 3): {0, 1}}
