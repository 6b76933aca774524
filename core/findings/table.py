"""The table of findings: of every note, by its code, how grave it is and what it does to what rests on the result.

A new note has a row here, or `tests/findings/test_table.py` fails. The order and colour of notes and the manual's page
on findings come from it; that nothing is proven comes from the facts (`core.findings.proof`), never from a note.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from core.findings.finding import Effect, Finding, Weight
from core.messages import Message


def _rows(weight: Weight, effect: Effect, codes: str) -> Iterable[Finding]:
    return (Finding(code, weight, effect) for code in codes.split())


_ALL = (
    *_rows(
        Weight.GRAVE,
        Effect.NO_PROOF,
        """
        api.points_alone
        fan.not_converged fan.point_off_target fan.points_off_in_region
        inspection.drifted_during_scan inspection.light_is_skewed inspection.missing_in_u_proves_nothing
        inspection.moved_during_scan inspection.planes_collapsed inspection.rig_has_changed
        inspection.rig_may_have_changed inspection.section_has_changed
        scan.collapsed scan.drifted scan.fan_has_moved scan.fan_is_elsewhere scan.fan_shifted scan.moved
        scan.section_changed
        study.doubted study.series_doubted
        target.size_unconfirmed
        validity.calibration_lapsed validity.calibration_undated validity.check_failed validity.check_lapsed
        validity.history_unreadable validity.never_checked validity.planes_not_settled validity.planes_unknown
        validity.scan_unknown validity.target_points_off
        """,
    ),
    *_rows(Weight.GRAVE, Effect.NO_RESULT, "feature.frame_not_measured gauge.none_measured inspection.no_frame"),
    *_rows(Weight.GRAVE, Effect.WIDENS_U, "target.sizes_disagree"),
    *_rows(Weight.GRAVE, Effect.NONE, "artefact.failed camera.bad_fit scan.fan_disagrees"),
    *_rows(
        Weight.CAUTION,
        Effect.WIDENS_U,
        """
        camera.bowed_target camera.corners_err_alike camera.corners_err_together
        fan.bow_or_bend fan.bowed_target fan.lines_bent fan.lines_wavy fan.poses_scatter
        form.bowed form.off_nominal form.scatter form.uneven form.uneven_along
        inspection.rig_not_checked
        part.material_assumed part.temperature_assumed
        profile.assumes_square profile.assumes_stage profile.not_straight
        scan.compressed scan.crossings_scatter scan.exposure_blur scan.fan_off_in_region scan.hours_assumed
        scan.kelvins_assumed scan.kelvins_since_check_assumed scan.rows_roll scan.scale_unknown scan.scale_weak
        scan.speckled scan.stability_assumed scan.stability_more_than_stated scan.warmer_than_usual
        target.flatness_assumed target.size_assumed
        """,
    ),
    *_rows(
        Weight.CAUTION,
        Effect.NONE,
        """
        artefact.lapsed
        camera.empty_regions camera.few_views camera.hot_pixels camera.imported camera.misfound_corners
        camera.pattern_in_region camera.pattern_outwards camera.small_tilts camera.too_few_to_compare
        camera.view_left_out camera.views_left_out_by_hand camera.views_without_target camera.worse_view
        check.another_day check.leaves_much check.pose_left_out
        fan.further_plane fan.outlying_pose fan.poorly_predicted fan.poses_left_out fan.saturated_stripes
        feature.master_too_different
        gauge.missing_in_u inspection.missing_in_u
        plugin.unusable
        profile.assumes_rest profile.one_line_on_part profile.stood_still
        scan.colour_mosaic scan.fan_light_unused scan.frames_lost scan.frames_moved scan.frames_without_points
        scan.hand_moved scan.many_frames_without_points scan.no_reference scan.points_unsure_by_motion
        scan.raw_mosaic scan.room_light_changed scan.second_bounces scan.shines scan.shutter_assumed
        stripes.told_width_wrong
        study.artefact_without_u study.beyond_run_chart study.bias_significant study.bias_too_large
        study.few_categories study.few_measurements study.few_positions study.few_repeats study.no_spread
        study.not_normal study.not_steady study.rule_broken study.scatter_alone study.series_no_spread
        study.series_too_short study.series_values_over study.series_without_u study.spread_beyond_limits
        target.not_both target.not_fixed
        validity.not_stated
        """,
    ),
    *_rows(
        Weight.INFORMATION,
        Effect.NONE,
        """
        artefact.passed
        camera.third_radial
        fan.readjusted
        feature.compared_with_master feature.scale_at_20 feature.stated_at_20
        part.surface_corrected part.thicknesses_alone
        plugin.measured_by
        profile.mean_of
        scan.change_by_warmth_and_time scan.further_exposures scan.further_exposures_moved scan.scale_fixed
        scan.stability_charted
        study.after_the_guideline study.breaks_by_chance study.interaction_pooled study.one_operator
        target.sizes_agree
        """,
    ),
)
FINDINGS: Mapping[str, Finding] = {row.code: row for row in _ALL}
"""By the code of the note."""
assert len(FINDINGS) == len(_ALL)


def weight_of(note: Message) -> Weight:
    """Weight of a note, or of the gravest one that it tells of a result; one of another package is a caution."""
    row = FINDINGS.get(note.code)
    told = [weight_of(one) for one in note.values.values() if isinstance(one, Message) and row is None]
    return max(told) if told else Weight.CAUTION if row is None else row.weight


def is_grave(note: Message) -> bool:
    """Whether a note, or the one that it tells of a result, is said first and in red."""
    return weight_of(note) == Weight.GRAVE


def gravest_first(notes: Iterable[Message]) -> tuple[Message, ...]:
    """Each note once, the gravest first, those of one weight in their order."""
    return tuple(sorted(dict.fromkeys(notes), key=lambda note: -weight_of(note)))
