"""XML documents: their elements, the numbers in them, and the file."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from core.files.atomic import write_bytes


def put(parent: Element, element_name: str, text: str = "", /, **attributes: str) -> Element:
    """Append a child element with `text` and attributes to `parent`, and return it; unprintable characters go."""
    element = ElementTree.SubElement(parent, element_name, attributes)
    if text:
        element.text = "".join(c for c in text if c.isprintable() or c in "\t\n")
    return element


def write_document(path: Path, root: Element) -> None:
    """Write an XML document, indented, to `path`; InputError if it cannot be written."""
    ElementTree.indent(root)
    write_bytes(path, ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n")


def decimal(value: float) -> str:
    """Write a number in decimal digits without an exponent, as xs:decimal."""
    text = f"{value:.12f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
