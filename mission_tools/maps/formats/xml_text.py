"""XML from files that nobody vouches for: no document types, hence no entities; bounded depth."""

from collections.abc import Iterator
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers.expat import ExpatError, ParserCreate

from mission_tools.errors import MapError

MAX_DEPTH = 100


def parse_xml(data: bytes, source: str) -> Element:
    """The root element; tags and attributes are without their namespaces.

    Raises:
        MapError: not XML, or XML with a document type.
    """
    builder = TreeBuilder()
    parser = ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    depth = 0

    def refuse(*_: object) -> None:
        raise MapError(f"{source}: has a document type (<!DOCTYPE): remove it; it is not needed")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise MapError(f"{source}: line {parser.CurrentLineNumber}: elements nested too deep")
        builder.start(_local(tag), {_local(name): value for name, value in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_local(tag))

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(data, True)
        return builder.close()
    except ExpatError as error:
        raise MapError(f"{source}: line {error.lineno}: not XML: {str(error).partition(':')[0]}") from None
    except MapError:
        raise
    except (LookupError, ValueError):
        raise MapError(f"{source}: not XML in an encoding that is known") from None


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def text_of(element: Element, path: str) -> str:
    """The text of a descendant; empty if there is none."""
    return (element.findtext(path) or "").strip()


def children(element: Element, *tags: str) -> Iterator[Element]:
    """The children with one of these tags."""
    return (child for child in element if child.tag in tags)
