"""Facts of a scan, all of which are known and none of which holds."""

from dataclasses import fields
from typing import Any

from core.findings.proof import ScanFacts

KNOWN: dict[str, Any] = {one.name: False for one in fields(ScanFacts) if one.name != "of_the_day"}
NOTHING_WRONG = ScanFacts(**KNOWN)
