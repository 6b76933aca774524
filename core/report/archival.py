"""A report as PDF/A-3b (ISO 19005-3, level B): a file that shows the same in decades, by what it holds itself.

What reportlab writes lacks the profile that its colours are meant in, the metadata as XMP and the mark of links that
they are printed, and has an empty transition on every page. Nothing that is seen is touched. The rules of the standard
named here are those of its clauses 6.2 to 6.8. Without attachments it is PDF/A-2b: the same rules but that only the
third part allows files of any kind in it.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from pikepdf import Array, AttachedFileSpec, Dictionary, Name, Pdf

_PRINTED = 4
"""Flag of an annotation (ISO 32000-1, 12.5.3): shown on paper, too."""
_ICC_DATE = slice(24, 36)
"""Where a profile says when it was made: that of the program that makes it anew would change the report's bytes."""
_NO_DATE = bytes((7, 234, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0))  # 2026-01-01


def archived(data: bytes, attachments: Mapping[str, bytes]) -> bytes:
    """Convert a report's PDF with attached JSON files to PDF/A-3b; without the PDF/A mark if a font is not embedded.

    The same bytes for the same report and files.
    """
    with Pdf.open(io.BytesIO(data)) as pdf:
        _attach(pdf, attachments)
        for page in pdf.pages:
            if Name.Trans in page.obj:
                del page.obj[Name.Trans]
            for annotation in page.obj.get(Name.Annots, ()):
                annotation[Name.F] = _PRINTED
        _add_output_intent(pdf)
        whole = all(_is_embedded(font) for font in _fonts(pdf))
        _add_metadata(pdf, part=("3" if attachments else "2") if whole else None)
        stream = io.BytesIO()
        pdf.save(stream, min_version="1.7", deterministic_id=True)
    return stream.getvalue()


def _fonts(pdf: Pdf) -> Iterator[Any]:
    for page in pdf.pages:
        yield from page.resources.get(Name.Font, Dictionary()).values()


def _is_embedded(font: Any) -> bool:
    described = font.get(Name.DescendantFonts, Array([font]))[0].get(Name.FontDescriptor, Dictionary())
    return any(name in described for name in (Name.FontFile, Name.FontFile2, Name.FontFile3))


@cache
def _srgb() -> bytes:
    """The ICC profile of sRGB, made by Little CMS, which asks for nothing in return: 'No copyright, use freely'."""
    from PIL import ImageCms

    made = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    made[_ICC_DATE] = _NO_DATE
    return bytes(made)


def _add_output_intent(pdf: Pdf) -> None:
    profile = pdf.make_stream(_srgb(), N=3, Alternate=Name.DeviceRGB)
    intent = Dictionary(
        Type=Name.OutputIntent,
        S=Name.GTS_PDFA1,
        OutputConditionIdentifier="sRGB",
        Info="sRGB IEC61966-2.1",
        DestOutputProfile=profile,
    )
    pdf.Root.OutputIntents = Array([pdf.make_indirect(intent)])


def _attach(pdf: Pdf, attachments: Mapping[str, bytes]) -> None:
    """The files, as the data that the pages show (clause 6.8), of the date of the report."""
    made = str(pdf.docinfo[Name.CreationDate])
    specs = [
        AttachedFileSpec(
            pdf,
            data,
            filename=name,
            description=name,
            mime_type="application/json",
            creation_date=made,
            mod_date=made,
            relationship=Name.Data,
        )
        for name, data in attachments.items()
    ]
    for spec in specs:
        pdf.attachments[spec.filename] = spec
    if specs:
        pdf.Root.AF = Array([pdf.attachments[spec.filename].obj for spec in specs])


def _add_metadata(pdf: Pdf, part: str | None) -> None:
    """What the file says of itself, as XMP; the same as in its older dictionary, which has to agree.

    `part` of the standard that it keeps to; None if it keeps to none.
    """
    if Name.Trapped in pdf.docinfo:
        del pdf.docinfo[Name.Trapped]  # XMP has no word for it
    with pdf.open_metadata(set_pikepdf_as_editor=False, update_docinfo=True) as meta:
        meta.load_from_docinfo(pdf.docinfo)
        if part is not None:
            meta["pdfaid:part"], meta["pdfaid:conformance"] = part, "B"
