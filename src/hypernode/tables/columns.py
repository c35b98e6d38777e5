"""What a column of a table is: the number it takes from a result file, its unit, and how that number is printed."""

import math
from dataclasses import KW_ONLY, dataclass, replace
from typing import Literal

#: How a column's numbers were judged -> the words for it under the table.
JUDGED_AT = {
    "prescribed": "every point undergoes the same prescribed deformation",
    "measured": "at the measured deformation, which is the differentiated measurement",
    "identified": "at the identified deformation, the equilibrium field or interpolant that the method itself uses",
}
#: Digits that are shown of a number; a file holds all of them.
DIGITS = 3
#: Below this, a number is shown as smaller than this.
SMALLEST = "0.0001"


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes:
        key: key of the number in the summary of a result file, or in the record of a job.
        style: ``percent`` (a fraction in the file), ``share`` (three decimals), ``number`` (three significant
            digits), ``count`` or ``text``.
        unit: unit in the file; ``length`` stands for that of the sheet.
        better: which value is the best of several, where one is.
        judged_at: a key of :data:`JUDGED_AT`, where a number depends on the deformation.
    """

    key: str
    style: Literal["percent", "share", "number", "count", "text"]
    _: KW_ONLY
    unit: str = "-"
    better: Literal["low", "high", ""] = ""
    judged_at: Literal["prescribed", "measured", "identified", ""] = ""

    @property
    def of_statistics(self) -> "Column":
        """The column of medians or means of its numbers: one of counts is no count."""
        return replace(self, style="number") if self.style == "count" else self

    def header(self, name: str, stored: bool = False) -> str:
        """The column's head: its name with the unit as shown, or with the one of the file."""
        if self.style in ("count", "text"):
            return name
        return f"{name} [{'%' if self.style == 'percent' and not stored else self.unit}]"

    def shown(self, value) -> str:
        """A value as printed; a dash where it is missing."""
        if value is None or value != value:
            return "-"
        if self.style == "text":
            return str(value)
        if self.style == "count":
            return f"{value:.0f}"
        if self.style == "share":
            return f"{value:.3f}"
        return significant(100.0 * value if self.style == "percent" else value)


def significant(value: float) -> str:
    """A number with three significant digits, never with an exponent; what is no number is said to be none."""
    if not math.isfinite(value):
        return "no number"
    if value == 0:
        return "0"
    if abs(value) < float(SMALLEST):
        return f"< {SMALLEST}" if value > 0 else f"> -{SMALLEST}"
    # The exponent after rounding: 9.999 has three digits as 10.0.
    exponent = int(f"{value:.{DIGITS - 1}e}".split("e")[1])
    return f"{value:.{max(DIGITS - 1 - exponent, 0)}f}"


def _error(key: str, judged_at="prescribed") -> Column:
    return Column(key, "percent", better="low", judged_at=judged_at)


def _overlap(key: str) -> Column:
    return Column(key, "share", better="high", judged_at="prescribed")


#: Columns that a table shows beyond those that are chosen, and what the same is called for a group of runs.
VERDICT, VERDICTS = "verdict", "verdicts"
_RUNS = {
    "stress error": _error("stress_error"),
    "all modes": _error("stress_error_all_modes"),
    "other modes": _error("stress_error_other_modes"),
    "off interface": _error("stress_error_off_interface"),
    "without ten cells": _error("stress_error_without_ten_cells"),
    "against cell means": _error("stress_error_cell_mean"),
    "contrast error": _error("contrast_error"),
    "misfit of u": Column("displacement_misfit", "number", unit="noise", judged_at="identified"),
    "misfit of forces": Column("force_misfit", "number", unit="noise", judged_at="identified"),
    "prediction of u": Column("left_out_displacement_misfit", "number", unit="noise", judged_at="identified"),
    "prediction of forces": Column("left_out_force_misfit", "number", unit="noise", judged_at="identified"),
    "held-out misfit of u": Column(
        "held_out_displacement_misfit", "number", unit="noise", better="low", judged_at="identified"
    ),
    "held-out misfit of forces": Column(
        "held_out_force_misfit", "number", unit="noise", better="low", judged_at="identified"
    ),
    "polish": Column("polish", "text"),
    "constrained field alone": _error("stress_error_constrained"),
    "networks against it": _error("network_error"),
    "spread": Column("spread", "percent", judged_at="prescribed"),
    "truth within two spreads": Column("within_two_spreads", "share", judged_at="prescribed"),
    "correlation": _overlap("correlation"),
    "Dice": _overlap("dice"),
    "registered Dice": _overlap("dice_registered"),
    "IoU": _overlap("iou"),
    "boundary distance": Column("boundary_distance", "number", unit="length", better="low", judged_at="prescribed"),
    "fibre angle error": Column("fibre_angle_error", "number", unit="degree", better="low", judged_at="prescribed"),
    "NRMSE matrix": _error("curve_nrmse_matrix"),
    "NRMSE inclusion": _error("curve_nrmse_inclusion"),
    "R2 matrix": _overlap("curve_r2_matrix"),
    "R2 inclusion": _overlap("curve_r2_inclusion"),
    "edge force error at measured F": _error("edge_force_error_measured", "measured"),
    "edge force error at identified F": _error("edge_force_error_identified", "identified"),
    "nodal residual at measured F": _error("equilibrium_residual_measured", "measured"),
    "nodal residual at identified F": _error("equilibrium_residual_identified", "identified"),
    "equilibrium gap at measured F": _error("equilibrium_gap_measured", "measured"),
    "equilibrium gap at identified F": _error("equilibrium_gap_identified", "identified"),
    "inclusion": Column("inclusion", "text", judged_at="prescribed"),
    "contrast seen": Column("contrast_seen", "percent", judged_at="prescribed"),
    "contrast needed": Column("contrast_needed", "percent", judged_at="prescribed"),
    "detectable contrast": Column("detectable_contrast", "percent", judged_at="prescribed"),
    "phases found": Column("phases_found", "count", judged_at="prescribed"),
    "inclusion / matrix": Column("inclusion_over_matrix", "number", judged_at="prescribed"),
    "interpolant misfit": Column("interpolant_misfit", "percent"),
    "SNR measured": Column("snr_measured", "number", unit="dB"),
    "SNR smoothed": Column("snr_smoothed", "number", unit="dB"),
    "SNR used": Column("snr_used", "number", unit="dB"),
    "smallest stretch seen": Column("smallest_stretch", "number", judged_at="identified"),
    "largest stretch seen": Column("largest_stretch", "number", judged_at="identified"),
    "parameters": Column("parameters", "count"),
}
_VALIDATION = {
    "u under unseen loads": _error("unseen_displacement_error", ""),
    "forces under unseen loads": _error("unseen_force_error", ""),
    "unseen loads without equilibrium": Column("unseen_without_equilibrium", "count", better="low"),
}
_REFERENCES = {
    "NRMSE of the matrix sheet": _error("reference_nrmse_matrix", ""),
    "NRMSE of the inclusion sheet": _error("reference_nrmse_inclusion", ""),
    "NRMSE of frames not used": _error("reference_nrmse_whole", ""),
}
#: Kind of table -> name -> column. The names are those that a configuration uses.
COLUMNS = {
    kind: columns | {"ending": Column("ending", "text"), VERDICT: Column("verdict", "text")}
    for kind, columns in (("runs", _RUNS), ("validation", _VALIDATION), ("references", _REFERENCES))
}
#: Kind of table -> what it shows where the configuration does not choose.
DEFAULT = {
    "runs": [
        "stress error",
        "all modes",
        "contrast error",
        "Dice",
        "spread",
        "misfit of u",
        "edge force error at measured F",
        "equilibrium gap at measured F",
    ],
    "validation": list(_VALIDATION),
    "references": list(_REFERENCES),
}
