"""Faults of a scan's pictures are told, and come first where a scan is refused."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from core.acquire.grey import to_grey
from core.errors import InputError
from core.image.mosaic import sites_of
from core.image.stripes.noise import Compression, NoiseModel
from core.messages import Message
from core.pipeline.steps.scan import judgement
from core.scan.features.picture_faults import (
    at_fault,
    faults_of,
    mosaic_of,
    notes_on_compression,
)
from core.scan.features.reference import read_reference
from core.scan.first_cause import cause_first
from core.scan.method import ReconstructOptions
from core.simulate.effects.sensor import SensorEffects
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario

COMPRESSED, MOSAIC, RAW, SPECKLED = "scan.compressed", "scan.colour_mosaic", "scan.raw_mosaic", "scan.speckled"
RIG = Scenario(scale=0.25, frames=4, seed=1)
MOVED = Message("scan.moved_too_much", "object or camera moved")


def faults_in(seen):
    return faults_of(seen, mosaic_of(seen.fan, seen.base))


def told_of(scenario):
    picture = to_grey(scan_of(scenario)[0].reference(), "red")
    return [note.code for note in faults_in(read_reference(picture))]


@pytest.mark.parametrize(
    ("scenario", "codes"),
    [
        pytest.param(replace(RIG, speckle=0.1), [], marks=pytest.mark.accuracy),
        (RIG, []),
        pytest.param(replace(RIG, seed=2), [], marks=pytest.mark.accuracy),
        (replace(RIG, speckle=0.35), [SPECKLED]),
        pytest.param(replace(RIG, speckle=0.35, seed=4), [SPECKLED], marks=pytest.mark.accuracy),
        pytest.param(replace(RIG, scale=0.5, speckle=0.6), [SPECKLED], marks=pytest.mark.accuracy),
    ],
)
def test_strong_speckle_is_told_and_no_other(scenario, codes):
    assert told_of(scenario) == codes


def test_lines_without_light_have_no_speckle():
    seen = read_reference(to_grey(scan_of(RIG)[0].reference(), "red"))
    dark = tuple(replace(piece, strength=np.zeros(len(piece))) for piece in seen.fan)
    assert faults_in(replace(seen, fan=dark)) == ()
    assert faults_in(replace(seen, fan=(seen.fan[0].select(slice(0, 1)),))) == ()


def is_too_fine(scenario):
    seen = read_reference(to_grey(scan_of(scenario)[0].reference(), "red"))
    return mosaic_of(seen.fan, seen.base).too_fine


@pytest.mark.parametrize(
    ("scale", "seed"), [(0.25, 1), *(pytest.param(*one, marks=pytest.mark.accuracy) for one in ((0.25, 3), (0.5, 2)))]
)
def test_a_raw_mosaic_of_which_nobody_told_is_told(scale, seed):
    raw = replace(RIG, scale=scale, seed=seed, sensor=SensorEffects(colour=True, raw=True))
    assert RAW in told_of(raw) and is_too_fine(raw)
    assert not is_too_fine(replace(raw, sensor=SensorEffects()))
    assert RAW not in told_of(replace(raw, sensor=SensorEffects()))
    picture = scan_of(raw)[0].reference()
    assert RAW not in [note.code for note in faults_in(read_reference(sites_of("RGGB", "red").of(picture)))]


@pytest.mark.accuracy
def test_stripes_finer_than_the_mosaic_they_are_interpolated_from_are_told():
    colour = replace(RIG, sensor=SensorEffects(colour=True))
    assert told_of(colour) == [MOSAIC] and is_too_fine(colour)
    assert not is_too_fine(replace(colour, scale=1.0))
    assert told_of(replace(colour, scale=1.0)) == [], "wide stripes lose nothing"


def test_frames_are_told_to_be_jpeg_where_that_rules_their_noise():
    assert notes_on_compression(NoiseModel(1.0)) == ()
    assert notes_on_compression(NoiseModel(1.0, compression=Compression(0.5))) == ()
    (note,) = notes_on_compression(NoiseModel(1.0, compression=Compression(3.0)))
    assert note.code == COMPRESSED
    assert "loses 3.0 grey levels" in str(note)


def test_a_refusal_begins_with_the_faults_of_the_pictures():
    faults = notes_on_compression(NoiseModel(1.0, compression=Compression(3.0)))
    with pytest.raises(InputError) as refused, cause_first(lambda: at_fault(faults)):
        raise InputError(MOVED, where="scan", todo=Message("x.y", "hold both still"))
    assert refused.value.what.values["faults"] == faults
    assert str(refused.value).startswith("scan: The frames are compressed")
    assert "may be why object or camera moved; mend that first" in str(refused.value)


def test_a_refusal_asks_for_faults_and_for_no_notes(monkeypatch):
    def refuse(*_):
        raise InputError(MOVED, where="scan")

    monkeypatch.setattr(judgement, "reconstruct_twice", refuse)
    told = notes_on_compression(NoiseModel(1.0, compression=Compression(3.0)))
    rig = SimpleNamespace(
        camera=SimpleNamespace(camera=None), fan=SimpleNamespace(fan=SimpleNamespace(lines=3)), planes=()
    )
    for notes, faults in (((), told), (told, ())):
        with pytest.raises(InputError) as refused:
            judgement.solved_scan(SimpleNamespace(notes=notes, faults=faults), rig, ReconstructOptions(), None)
        assert ("The frames are compressed" in str(refused.value)) == bool(faults)


def test_a_refusal_of_faultless_pictures_stays_as_it_is():
    error = InputError(MOVED, where="scan")
    with pytest.raises(InputError) as refused, cause_first(lambda: at_fault(())):
        raise error
    assert refused.value is error


def test_a_film_that_does_not_tell_its_loss_is_told_however_large_the_noise():
    for noise in (1.0, 9.0):
        (note,) = notes_on_compression(NoiseModel(noise, compression=Compression(5.8, assumed=True)))
        assert note.code == "scan.compression_assumed"
        assert "5.8 grey levels are assumed" in str(note)
