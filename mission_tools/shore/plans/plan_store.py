"""The latest plans, in a temporary folder of the server. Their ids cannot be guessed."""

import contextlib
import re
import shutil
import tempfile
from collections import OrderedDict
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from companion.core.errors import StorageError
from mission_tools.shore.plans.plan_request import Lists, MadePlan
from mission_tools.station.words import say

MOST_PLANS: Final = 16
MOST_NAME: Final = 60
_NOT_IN_NAMES: Final = re.compile(r"[^A-Za-z0-9]+")


class StoredPlan(NamedTuple):
    """A plan. folder: holds it as `file_name(plan.name)`.plan."""

    plan: MadePlan
    lists: Lists
    folder: Path


class PlanStore:
    """The plans by id, the oldest first."""

    def __init__(self) -> None:
        self._root: Path | None = None
        self._kept: OrderedDict[str, StoredPlan] = OrderedDict()

    def new_folder(self) -> Path:
        """An empty folder; StorageError if there is no room, or nothing may be written."""
        try:
            if self._root is None:
                self._root = Path(tempfile.mkdtemp(prefix="boat-shore-plans-"))
            return Path(tempfile.mkdtemp(dir=self._root))
        except OSError as error:
            raise StorageError(say("planner.no_room", why=error.strerror or str(error))) from None

    @contextlib.contextmanager
    def scratch(self) -> Iterator[Path]:
        """A folder for a while."""
        folder = self.new_folder()
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def keep(self, kept: StoredPlan) -> None:
        """Add a plan; the oldest beyond MOST_PLANS go."""
        self._kept[kept.plan.id] = kept
        while len(self._kept) > MOST_PLANS:
            _, oldest = self._kept.popitem(last=False)
            shutil.rmtree(oldest.folder, ignore_errors=True)

    def find(self, ident: str) -> StoredPlan | None:
        """A plan; None if it was never made, or is too old."""
        return self._kept.get(ident)

    def close(self) -> None:
        root, self._root = self._root, None
        self._kept.clear()
        if root is not None:
            shutil.rmtree(root, ignore_errors=True)


def file_name(name: str) -> str:
    """A name as a file's name without suffix: letters, digits and hyphens, never empty."""
    return _NOT_IN_NAMES.sub("-", name).strip("-")[:MOST_NAME].strip("-") or "plan"
