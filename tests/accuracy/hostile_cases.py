"""Which effects of real rigs the hostile table tries, how strong, and which notes name each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from core.calibrate.board_shape import SUSPECTED_SCALE, BoardTolerance
from core.files.recording.rig import Rig
from core.inspect.uncertainty.part import Part
from core.simulate.effects.laser import GAUSSIAN_LASER, LaserEffects
from core.simulate.effects.lens import IDEAL_LENS, LensEffects
from core.simulate.effects.plates import PlateEffects
from core.simulate.effects.room import RoomEffects
from core.simulate.effects.sensor import SensorEffects
from core.simulate.effects.setup import Setup
from core.simulate.effects.warming import Warming
from core.simulate.sample import METAL_AT_20
from core.simulate.scenario import Scenario

SEEDS = (1, 2, 3)
CHECK_POSES = 3


@dataclass(frozen=True, slots=True)
class Effect:
    """One effect, or several at once, at growing strengths: each a label and fields of a scenario."""

    title: str
    strengths: Sequence[tuple[str, Mapping[str, Any]]]


NOTHING_STATED = "–, nothing stated"
"""Strength at which rig.toml says nothing of the targets' sizes and of the part."""

SKEWED_SINCE = "lasers or lens skewed since the calibration"
"""The one effect whose laser and lens are those of the scan alone."""

EFFECTS = (
    Effect("nothing", [("–", {}), (NOTHING_STATED, {})]),
    Effect(
        "second bounces between table and part's sides",
        [(f"{share:.0%}", {"mirror_share": share}) for share in (0.1, 0.15, 0.2, 0.3, 0.6)],
    ),
    Effect(
        "lamps that flicker at 100 Hz",
        [
            ("20 %", {"room": RoomEffects(flicker=0.2)}),
            ("60 %", {"room": RoomEffects(flicker=0.6)}),
            ("60 %, rows in 71 ms", {"room": RoomEffects(flicker=0.6), "readout_ms": 71.0}),
        ],
    ),
    Effect(
        "a lamp switched within the scan",
        [
            ("+50 %", {"room": RoomEffects(lamp_frame=15, lamp_change=0.5)}),
            ("+300 %", {"room": RoomEffects(lamp_frame=15, lamp_change=3.0)}),
            ("−80 %", {"room": RoomEffects(lamp_frame=15, lamp_change=-0.8)}),
        ],
    ),
    Effect("a shadow that passes", [(f"{share:.0%}", {"room": RoomEffects(shadow=share)}) for share in (0.3, 0.8)]),
    Effect(
        "the rig warms within the scan",
        [
            ("0.1 px", {"warming": Warming(scan_px=0.1, scan_focal_ppm=50, scan_urad=20)}),
            ("0.3 px", {"warming": Warming(scan_px=0.3, scan_focal_ppm=150, scan_urad=100)}),
            ("1 px", {"warming": Warming(scan_px=1.0, scan_focal_ppm=500, scan_urad=300)}),
        ],
    ),
    Effect(
        "the rig warmed since its calibration",
        [
            ("0.1 px", {"drifted_px": 0.1, "turned_urad": 50.0, "warming": Warming(focal_ppm=100)}),
            ("0.3 px", {"drifted_px": 0.3, "turned_urad": 262.0, "warming": Warming(focal_ppm=300)}),
            ("1 px", {"drifted_px": 1.0, "turned_urad": -262.0, "warming": Warming(focal_ppm=-500)}),
        ],
    ),
    Effect(
        "the rig was knocked since its calibration",
        [("picture by 10 px", {"drifted_px": 10.0}), ("laser by 10 mrad", {"turned_urad": -1e4})],
    ),
    Effect(
        "exposed too long, blooming",
        [
            ("4 ×, 5 %", {"sensor": SensorEffects(brightness=4.0, bloom=0.05, smear=1e-5)}),
            ("4 ×, 50 %", {"sensor": SensorEffects(brightness=4.0, bloom=0.5, smear=1e-4)}),
            ("8 ×, 90 %", {"sensor": SensorEffects(brightness=8.0, bloom=0.9, smear=1e-3)}),
        ],
    ),
    Effect(
        "automatic exposure",
        [(f"± {share:.0%}", {"sensor": SensorEffects(automatic_exposure=share)}) for share in (0.1, 0.3)],
    ),
    Effect(
        "camera's target bowed",
        [(f"{bow} mm", {"plates": PlateEffects(camera_bow_mm=bow)}) for bow in (0.2, 0.6, 1.5)],
    ),
    Effect(
        "plane target bowed",
        [(f"{bow} mm", {"plates": PlateEffects(plane_bow_mm=bow)}) for bow in (0.1, 0.3, 1.0)],
    ),
    Effect(
        "camera's target larger",
        [(f"{1000 * larger:g} ‰", {"plates": PlateEffects(camera_scale=larger)}) for larger in (0.001, 0.005, 0.02)],
    ),
    Effect(
        "plane target larger",
        [(f"{1000 * larger:g} ‰", {"plates": PlateEffects(plane_scale=larger)}) for larger in (0.001, 0.005, 0.02)],
    ),
    Effect("lens with k3", [(f"{k3:g}", {"lens": LensEffects(k3=k3)}) for k3 in (0.3, 1.0, 3.0)]),
    Effect(
        "lasers that are no Gaussian across",
        [
            ("flat, exponent 6", {"laser": LaserEffects(edge=6.0)}),
            ("halo of 15 %", {"laser": LaserEffects(halo=0.15)}),
            ("shoulder of 30 %", {"laser": LaserEffects(shoulder=0.3)}),
        ],
    ),
    Effect(
        SKEWED_SINCE,
        [(f"shoulder of {share:.0%}", {"laser": LaserEffects(shoulder=share)}) for share in (0.1, 0.3)]
        + [("coma of 12 px", {"lens": LensEffects(coma_px=12.0)})],
    ),
    Effect("coma", [(f"{px:g} px", {"lens": LensEffects(coma_px=px)}) for px in (2.0, 6.0)]),
    Effect("defocus", [(f"{mm:g} mm", {"lens": LensEffects(aperture_mm=mm)}) for mm in (1.0, 3.0, 6.0)]),
    Effect("JPEG", [(f"quality {q}", {"sensor": SensorEffects(jpeg_quality=q)}) for q in (90, 60, 30)]),
    Effect(
        "Bayer mosaic",
        [
            ("lossless", {"sensor": SensorEffects(colour=True)}),
            ("JPEG 4:2:0, 75", {"sensor": SensorEffects(colour=True, jpeg_quality=75)}),
        ],
    ),
    Effect("hot pixels", [(f"{share:g}", {"sensor": SensorEffects(hot_share=share)}) for share in (1e-4, 2e-3)]),
    Effect(
        "translucent part",
        [
            (f"{share:.0%} from {mm} mm", {"inner_share": share, "inner_mm": mm})
            for share, mm in ((0.15, 0.8), (0.35, 1.2))
        ],
    ),
    Effect("glossy part", [(f"{gloss:g} ×", {"gloss": gloss}) for gloss in (3.0, 20.0)]),
    Effect(
        "glossy part with a lay",
        [
            (
                f"{gloss:g} ×, {along:g}° × {across:g}°, at {lay:g}°",
                {"gloss": gloss, "gloss_along_deg": along, "gloss_deg": across, "lay_deg": lay},
            )
            for gloss, along, across, lay in ((5.0, 2.0, 6.5, 45.0), (20.0, 2.0, 6.5, 90.0), (100.0, 1.6, 3.6, 90.0))
        ],
    ),
    Effect("fan lines that bow", [(f"{bow}", {"fan_bow": bow}) for bow in (0.003, 0.01, 0.05)]),
    Effect("speckle", [(f"contrast {contrast}", {"speckle": contrast}) for contrast in (0.35, 0.6)]),
    Effect(
        "hand that moves",
        [
            ("14 mm/s", {"readout_ms": 71.0, "hand_mm_s": 14.0}),
            ("28 mm/s, tremor", {"readout_ms": 71.0, "hand_mm_s": 28.0, "tremor_mm": 0.35}),
        ],
    ),
    Effect(
        "something moves within the scan",
        [
            ("part up by 0.1 mm", {"lifted_mm": 0.1, "moved_frame": 22}),
            ("part up by 0.4 mm", {"lifted_mm": 0.4, "moved_frame": 22}),
            ("camera by 0.5 px", {"bumped_px": 0.5, "moved_frame": 18}),
        ],
    ),
    Effect(
        "three at once",
        [
            (
                "warm rig, flicker, JPEG 60",
                {
                    "drifted_px": 0.3,
                    "turned_urad": 100.0,
                    "room": RoomEffects(flicker=0.4),
                    "sensor": SensorEffects(jpeg_quality=60),
                },
            ),
            (
                "translucent, bowed fan, shadow",
                {"inner_share": 0.25, "fan_bow": 0.005, "room": RoomEffects(shadow=0.6)},
            ),
            (
                "second bounces, blooming, coma",
                {
                    "mirror_share": 0.4,
                    "sensor": SensorEffects(brightness=4.0, bloom=0.3),
                    "lens": LensEffects(coma_px=3.0),
                },
            ),
            (
                "bowed board, k3, hot pixels",
                {
                    "plates": PlateEffects(camera_bow_mm=0.4),
                    "lens": LensEffects(k3=0.6),
                    "sensor": SensorEffects(hot_share=5e-4),
                },
            ),
        ],
    ),
)


BOUNCES, LIGHT = "second bounces between table and part's sides", "scan.room_light_changed"
CHANGED = (
    "cause.rig_changed", "scan.fan_has_moved", "inspection.rig_has_changed", "inspection.rig_may_have_changed",
    "validity.check_failed", "gauge.changed_and_no_faces", "scan.changed_and_not_solved", "scan.explained_by_change",
)  # fmt: skip
MOVEMENT = (
    "scan.moved", "scan.fan_shifted", "inspection.moved_during_scan", "scan.moved_too_early", "scan.moved_too_much",
    "gauge.moved_and_no_faces", "scan.frames_moved", "cause.moved",
)  # fmt: skip
DRIFT = (
    "cause.drifted", "scan.drifted", "scan.drifted_too_much", "inspection.drifted_during_scan",
    "gauge.drifted_and_no_faces",
)  # fmt: skip
LENS = ("camera.corners_err_together", "camera.pattern_outwards", "camera.pattern_in_region", "camera.bad_fit")
CAUSES: Mapping[str, tuple[str, ...]] = {
    "nothing": (),
    BOUNCES: ("scan.fan_light_ambiguous", "scan.second_bounces", "cause.second_bounces"),
    "lamps that flicker at 100 Hz": (LIGHT,),
    "a lamp switched within the scan": (LIGHT,),
    "a shadow that passes": (LIGHT,),
    "the rig warms within the scan": (*CHANGED, *DRIFT, "scan.fan_shifted"),
    "the rig warmed since its calibration": CHANGED,
    "the rig was knocked since its calibration": CHANGED,
    "exposed too long, blooming": ("scan.overexposed", "scan.bright_in_part", "fan.saturated_stripes"),
    "automatic exposure": ("scan.brightness_changed", "fan.brightness_changed"),
    "camera's target bowed": ("camera.bowed_target", "fan.bow_not_as_camera"),
    "plane target bowed": ("fan.bowed_target", "fan.bow_or_bend", "fan.bow_beyond_flatness"),
    "camera's target larger": ("target.sizes_disagree",),
    "plane target larger": ("target.size_unconfirmed", "target.sizes_disagree"),
    "lens with k3": (*LENS, "camera.third_radial"),
    "lasers that are no Gaussian across": ("gauge.unsure_and_no_faces", "inspection.light_is_skewed"),
    SKEWED_SINCE: (*CHANGED, "scan.section_changed", "inspection.section_has_changed", "inspection.light_is_skewed"),
    "coma": (*LENS, "inspection.light_is_skewed"),
    "defocus": ("scan.check_out_of_focus", "scan.stripe_width_changed"),
    "JPEG": ("scan.compressed",),
    "Bayer mosaic": ("scan.colour_mosaic", "scan.compressed"),
    "hot pixels": ("camera.hot_pixels", "camera.misfound_corners"),
    "translucent part": ("inspection.light_is_skewed", "scan.stripes_wider_on_part", "part.material_assumed"),
    "glossy part": ("inspection.light_is_skewed", "scan.shines"),
    "glossy part with a lay": ("inspection.light_is_skewed", "scan.shines"),
    "fan lines that bow": (
        "fan.bow_or_bend",
        "fan.lines_bent",
        "fan.lines_wavy",
        "gauge.bent_and_no_faces",
        "cause.bent_lines",
    ),
    "speckle": ("scan.speckled", "form.scatter"),
    "hand that moves": ("scan.hand_moved", "scan.points_unsure_by_motion", "scan.rows_roll", "cause.hand_moved"),
    "something moves within the scan": MOVEMENT,
}
"""Codes of notes and refusals that name the cause of each effect: no other counts as told."""
TOGETHER: Mapping[str, tuple[str, ...]] = {
    "warm rig, flicker, JPEG 60": ("the rig warmed since its calibration", "lamps that flicker at 100 Hz", "JPEG"),
    "translucent, bowed fan, shadow": ("translucent part", "fan lines that bow", "a shadow that passes"),
    "second bounces, blooming, coma": (BOUNCES, "exposed too long, blooming", "coma"),
    "bowed board, k3, hot pixels": ("camera's target bowed", "lens with k3", "hot pixels"),
}
"""Which effects act at the strengths of "three at once": any of their causes counts."""


@dataclass(frozen=True, slots=True)
class HostileCase:
    """One scan: the effect, its strength, and the scenario."""

    effect: str
    strength: str
    scenario: Scenario

    @property
    def causes(self) -> frozenset[str]:
        """Codes that name the cause."""
        return frozenset(code for title in TOGETHER.get(self.strength, (self.effect,)) for code in CAUSES[title])

    @property
    def calibration(self) -> Scenario:
        """The scenario of its calibration pictures alone: cases for which it is the same share them."""
        scenario = self.scenario
        if self.effect == SKEWED_SINCE:
            scenario = replace(scenario, laser=GAUSSIAN_LASER, lens=IDEAL_LENS)
        ideal = base(scenario.scale)
        return replace(
            ideal,
            seed=scenario.seed,
            fan_bow=scenario.fan_bow,
            speckle=scenario.speckle,
            laser=scenario.laser,
            lens=scenario.lens,
            plates=scenario.plates,
            sensor=replace(scenario.sensor, brightness=1.0),
            setup=Setup(fan_turned_deg=scenario.setup.fan_turned_deg),
            frames=0,
        )

    @property
    def states_size(self) -> bool:
        """Whether rig.toml states how true the plane target is, as large as it assumes otherwise.

        Else nothing is ever conforming, and no other effect could be silent.
        """
        return self.effect != "plane target larger" and self.strength != NOTHING_STATED

    @property
    def states_part(self) -> bool:
        """Whether rig.toml states what the part is made of, and its temperature."""
        return not self.scenario.inner_share and self.strength != NOTHING_STATED

    def stated(self, rig: Rig) -> Rig:
        """What rig.toml says of that."""
        board = BoardTolerance(scale_sd=SUSPECTED_SCALE) if self.states_size else BoardTolerance()
        return replace(rig, plane_board=board, part=METAL_AT_20 if self.states_part else Part())

    @property
    def name(self) -> str:
        """Its own for each scenario: results are kept under it."""
        return f"{self.effect}, {self.strength}, {self.scenario.key}"


def base(scale: float) -> Scenario:
    """The rig to which all happens: its stability, and how flat its plates are, is not stated, as in most rig.toml."""
    many = scale >= 0.5
    return Scenario(
        scale=scale,
        frames=48 if many else 36,
        camera_views=14 if many else 10,
        plane_poses=9 if many else 8,
        stated=False,
    )


def hostile_cases(
    scale: float, seeds: Sequence[int] = SEEDS, checks: Sequence[int] = (0, CHECK_POSES)
) -> list[HostileCase]:
    """All scans, those of one strength after one another."""
    return [
        HostileCase(effect.title, label, replace(base(scale), seed=seed, check_poses=check, **fields))
        for seed in seeds
        for check in checks
        for effect in EFFECTS
        for label, fields in effect.strengths
    ]
