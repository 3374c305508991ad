"""A medium that takes its time, for tests: nothing is on it before `finish`, and then perhaps not."""

from companion.core.storage import MemoryStorage, Saving


class HeldSaving(Saving):
    """A save that ends when the test says so."""

    told: str | None = None

    def is_done(self) -> bool:
        return self.told is not None

    def error(self) -> str:
        return self.told or ""


class HeldStorage(MemoryStorage):
    """Keeps what is under way until the test lets it end."""

    def __init__(self) -> None:
        super().__init__()
        self.under_way: list[tuple[str, bytes, HeldSaving]] = []

    def save(self, name: str, content: bytes) -> Saving:
        self.under_way.append((name, content, HeldSaving()))
        return self.under_way[-1][2]

    def finish(self, error: str = "", only: str = "") -> None:
        """End the saves, or only those of one file."""
        for name, content, saving in [one for one in self.under_way if only in ("", one[0])]:
            saving.told = error
            if not error:
                self.content[name] = content
        self.under_way = [one for one in self.under_way if not one[2].is_done()]
