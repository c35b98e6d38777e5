"""The ten numbers of a run that matter most, in words."""

from collections.abc import Mapping

from hypernode.evaluation.ratios import Ratio
from hypernode.tables.columns import significant

#: Number of a summary -> its words, and what it is multiplied by.
FACTS = {
    "ending": ("Search for the equilibrium field", None),
    "displacement_misfit": ("Displacement misfit over its error", 1.0),
    "force_misfit": ("Force misfit over its error", 1.0),
    "edge_force_error_identified": ("Edge forces missed by, at most [%]", 100.0),
    "equilibrium_gap_identified": ("Stress out of equilibrium by, at most [%]", 100.0),
    "spread": ("Spread of the stiffness [%]", 100.0),
    "phases_found": ("Phases found", None),
    "inclusion_over_matrix": ("Stiffness of the inclusion over that of the matrix", 1.0),
    "stress_error": ("Error of the stress against the truth [%]", 100.0),
    "dice": ("Dice score of the shape", 1.0),
}


def facts(summary: Mapping) -> list[tuple[str, str]]:
    """(words, value) of what the summary of a run says of :data:`FACTS`."""
    return [(words, fact(summary, key)) for key, (words, _) in FACTS.items() if fact(summary, key)]


def fact(summary: Mapping, key: str) -> str:
    """One of :data:`FACTS`, or "" where the summary does not know it."""
    value, factor = summary.get(key), FACTS[key][1]
    if value is None:
        return ""
    if key == "inclusion_over_matrix":
        # The other phases are softer: of a part that may be rigid a lower bound is the answer.
        ratios = [Ratio(**each) for each in summary.get("stiffness_ratios", ())]
        if float(value) > 1.0 and len(ratios) == 1 and ratios[0].most is None:
            return ratios[0].words
    return str(value) if factor is None else significant(factor * float(value))
