"""What studies decide, and why they prove nothing, has its words in the tables of the house, which have no others."""

from typing import get_args

from core import states
from core.findings.finding import Effect
from core.findings.of_proof import DAY, REASONS, UNNAMED
from core.findings.table import all_findings
from core.inspect.conformity import Verdict
from core.wings.studies.findings import ROWS
from core.wings.studies.kinds.grr import Fitness
from core.wings.studies.kinds.type1 import Capability


def test_every_decision_has_its_words():
    assert set(states.DECISIONS) == {*Verdict, *get_args(Fitness), *get_args(Capability)}


def test_every_fact_by_which_nothing_is_proven_has_its_reason():
    facts = {row.fact for row in all_findings().values() if row.effect == Effect.NO_PROOF}
    assert facts | {UNNAMED, DAY} == set(REASONS)


def test_a_study_proves_nothing_by_these_facts_alone():
    assert {row.fact for row in ROWS} == {"", "results_doubted", "scatter_alone", "artefact_without_u"}
