"""The pages of a PDF as pictures, to be looked at before they are handed over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.progress import Progress, silent, steps

Pages = tuple[NDArray[np.uint8], ...]
"""Each page (height, width, 3), red, green, blue."""


def page_pictures(pdf: bytes, width_px: int = 900, progress: Progress = silent) -> Pages:
    """Draw every page of a PDF as a picture `width_px` wide.

    Raises
    ------
    pypdfium2.PdfiumError
        If these bytes are no PDF.
    """
    import pypdfium2 as pdfium  # comes with the window, which alone shows pages

    document = pdfium.PdfDocument(pdf)
    try:
        drawn = []
        for page in steps(document, progress, "pages", len(document)):
            picture = page.render(scale=width_px / page.get_width(), rev_byteorder=True).to_numpy()
            drawn.append(np.array(picture[:, :, :3]))  # the bitmap's memory goes with the page
        return tuple(drawn)
    finally:
        document.close()
