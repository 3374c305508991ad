"""The page in docs/ is what the table says."""

from pathlib import Path

from companion.config.parameter_page import parameter_page

PAGE = Path(__file__).parents[3] / "docs" / "parameters.md"


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == parameter_page(), (
        "run: boat-companion params --markdown > docs/parameters.md"
    )
