"""A computer as the doctor sees it. A plugin rather than a conftest.py, as in tests/e2e."""

from pathlib import Path

import pytest
from doctor_tree import Examine, Tree

from companion.app.doctor.findings import Examined
from companion.app.install.target import Target
from companion.config.boat_config import BoatConfig


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    """Makes files by their paths on that computer, below one folder."""

    def make(files: dict[str, str]) -> Path:
        root = tmp_path / "root"
        for name, text in files.items():
            path = root / name.removeprefix("/")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        root.mkdir(exist_ok=True)
        return root

    return make


@pytest.fixture
def examine(tree: Tree) -> Examine:
    """A computer with these files, and a boat of this configuration."""

    def make(files: dict[str, str], config: BoatConfig | None = None) -> Examined:
        return Examined(Target(tree(files)), config or BoatConfig())

    return make
