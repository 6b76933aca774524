"""Run as a program: render a small picture off screen with VTK. Ends with 0 if it came out right."""

from __future__ import annotations

import sys

import numpy as np


def renders() -> bool:
    """Whether an off-screen render window shows the background it was given."""
    import pyvista

    from workbench.views.scene_view_stage import Stage, read_pixels

    plotter = pyvista.Plotter(off_screen=True, window_size=[16, 16])
    window = plotter.render_window
    if window is None:
        return False
    stage = Stage(window)
    stage.set_background((200, 100, 50))
    window.Render()
    pixels = read_pixels(window).reshape(-1, 3)
    stage.close()
    plotter.close()
    return bool(np.abs(np.median(pixels, axis=0) - (200, 100, 50)).max() < 4)


if __name__ == "__main__":
    sys.exit(0 if renders() else 1)
