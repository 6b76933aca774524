"""Light that goes further than from laser to surface to lens: ends of a sheet, window and hand, bounces, matter."""

from __future__ import annotations

from dataclasses import dataclass

from core.simulate.effects.ranges import require_ranges


@dataclass(frozen=True, slots=True)
class Transport:
    """Effects of light on its way, as in a path tracer and in a workshop, beyond one reflection. All is off where
    nothing is stated.

    That a laser's light falls with distance and with the cosine of incidence, and that its sheet is wider where it
    meets a surface obliquely, is in every picture (`core.simulate.scene.laser`).

    Parameters
    ----------
    sheet_deg, edge_deg
        Half angle to which both lasers' sheets reach, where the rim of their housing cuts them off, and over which
        their light fades there: what the rim hides of a line lens of some width. 0: they end by themselves.
    window_deg
        Half of the angle that the window has from which the room's directed light comes: objects cast shadows on the
        table then, with edges as soft. 0: the light has no place and casts none.
    hand_mm
        Radius of the hand that holds the laser, a ball behind its emitter: it takes the window's light from what it
        stands before, frame by frame. Needs a window.
    bounced
        Whether surfaces light each other with the lasers' light that they send back evenly: once, by their form
        factors; neither may hide them from each other.
    scattered, free_path_mm, scatter_albedo
        Share of the lasers' light that enters the object, how far it goes there between two collisions, and how much
        of it goes on at each: `core.simulate.scene.walk` follows it. Plastics and wax have free paths of 0.1 to 1 mm
        and albedos of 0.95 to 0.999.
    """

    sheet_deg: float = 0.0
    edge_deg: float = 2.0
    window_deg: float = 0.0
    hand_mm: float = 0.0
    bounced: bool = False
    scattered: float = 0.0
    free_path_mm: float = 0.3
    scatter_albedo: float = 0.98

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("sheet_deg", 0.0, 89.0),
                ("edge_deg", 0.1, 45.0),
                ("window_deg", 0.0, 60.0),
                ("hand_mm", 0.0, 300.0),
                ("scattered", 0.0, 1.0),
                ("free_path_mm", 0.01, 5.0),
                ("scatter_albedo", 0.0, 1.0),
            ),
        )


ONE_WAY = Transport()
"""From laser to surface to lens."""
