"""The process that makes triangles of a STEP file: `python -m core.files.cad_tessellation STEP GLB CHORD_MM TURN_RAD`.

Its exit code is the CAD kernel's.
"""

import sys


def main() -> int:
    """Run as a program: write the triangles of the STEP file named first to the binary glTF file named second."""
    sys.modules["trimesh"] = None  # type: ignore[assignment]  # cascadio would load it, and scipy, to tell it of itself
    import cascadio

    step, glb, chord_mm, turn_rad = sys.argv[1:]
    return int(cascadio.step_to_glb(step, glb, float(chord_mm), float(turn_rad)))


if __name__ == "__main__":
    sys.exit(main())
