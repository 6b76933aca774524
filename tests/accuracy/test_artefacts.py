"""A sphere and a step of the twin as known artefacts: the true certificate passes, a wrong one fails."""

import json

import pytest

from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.simulated import trisect

pytestmark = pytest.mark.accuracy
ARTEFACT = '[[artefact]]\nid = "{id}"\nkind = "{kind}"\nvalue_mm = {value:.4f}\nU_mm = 0.0006\n'


@pytest.mark.parametrize(
    ("thing", "feature", "kind", "certified_mm", "characteristic"),
    [("sphere", "sphere", "sphere", 50.0, "it diameter"), ("steps", "steps", "step", 60.0, "it height 3")],
    ids=["sphere", "step"],
)
def test_an_artefact_passes_by_its_true_certificate_and_fails_by_a_wrong_one(
    tmp_path, thing, feature, kind, certified_mm, characteristic
):
    made, out, plan = tmp_path / "set", tmp_path / "out", tmp_path / "plan.toml"
    simulate_set(Scenario(object=thing, height_mm=50.0, seed=11, scale=0.5, frames=60), made)
    plan.write_text(f'[[feature]]\nname = "it"\nkind = "{feature}"\n')
    assert trisect("run", made, "--out", out).code in (0, 1)
    assert trisect("inspect", made, "--plan", plan, "--out", out).code in (0, 1)

    def compared(value_mm: float) -> dict[str, float | str]:
        (made / "artefacts.toml").write_text(ARTEFACT.format(id="it", kind=kind, value=value_mm))
        said = trisect("artefact", made, "--out", out, "--id", "it", "--characteristic", characteristic, "--json")
        assert said.code in (0, 1), said.err
        return dict(json.loads(said.out))

    right = compared(certified_mm)
    u = float(right["unseen_mm"]) / 2
    print(f"{kind}: {right['error_mm']:+.4f} mm, u {u:.4f} mm, E_n {right['e_n']:+.2f}")
    assert right["verdict"] == "passed" and u < 0.05
    assert [compared(certified_mm + off * u)["verdict"] for off in (-5, 5)] == ["failed", "failed"]
