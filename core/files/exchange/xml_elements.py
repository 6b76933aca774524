"""Elements of an XML document and the numbers in them."""

from __future__ import annotations

from xml.etree import ElementTree
from xml.etree.ElementTree import Element


def put(parent: Element, element_name: str, text: str = "", /, **attributes: str) -> Element:
    """A new last child, its text without what XML cannot hold."""
    element = ElementTree.SubElement(parent, element_name, attributes)
    if text:
        element.text = "".join(c for c in text if c.isprintable() or c in "\t\n")
    return element


def decimal(value: float) -> str:
    """xs:decimal: no exponent."""
    text = f"{value:.12f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
