"""Limits beyond which the criteria of a verdict warn and fail."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Threshold:
    """Limits beyond which a criterion warns and fails."""

    warn: float
    fail: float


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Every threshold of a verdict. Each follows from the meaning of its number, and from no single case."""

    #: Standard deviations of the misfit of displacements that chance makes: beyond three once in 700 runs.
    chance: float = 3.0
    #: Excess of the misfit that does not count: noise itself is seldom known to better than a twentieth.
    noise_known: float = 0.05
    #: Misfit of displacements of which three quarters of the squares are no noise.
    misfit_fail: float = 2.0
    #: Misfit below which the field has taken up more than a third of what independent noise leaves, 1 - 0.8^2.
    misfit_low: float = 0.8
    #: Uncertainty of a window that nobody stated, over its side or a step between points, up to which points beside
    #: interfaces weigh as if it were stated.
    window_known: float = 0.1
    #: Relative uncertainty below which no force is believed: that of a testing machine of class 1 after ISO 7500-1.
    force_uncertainty: float = 0.01
    #: Deformation between neighbouring points, over the largest of a test, that counts for no stress: as much as an
    #: extensometer of class 1 may miss after ISO 9513.
    deformation: float = 0.01
    #: Deformation of the largest load steps, over the largest of a test, by which a prediction from the others may miss
    #: it beyond chance: as much as an answer may be off and be right, and more than that.
    predicted: Threshold = Threshold(0.03, 0.05)
    #: Share of the sheet, corners apart, in which displacements are not explained: a fiftieth of it changes no stress
    #: elsewhere, and what is not explained in a quarter of the sheet is not a place.
    places: Threshold = Threshold(0.02, 0.25)
    #: Share of the displacements that were mistaken: where it is more, so is what was mistaken and not found.
    outliers: Threshold = Threshold(0.01, 0.10)
    #: Uncertainties by which forces may be missed: three by chance, and ten by no chance and no drift of a load cell.
    force: Threshold = Threshold(3.0, 10.0)
    #: What no material of the basis follows, over the forces: as much as a load cell and the scatter between frames
    #: make, and a share of the force that would fail by itself.
    law: Threshold = Threshold(0.015, 0.10)
    #: By how much networks may miss the field that they learnt: they do by a thousandth where they are trained well,
    #: and what they miss is theirs alone.
    networks: Threshold = Threshold(0.01, 0.10)
    #: The true stress is in equilibrium, so that the identified one is wrong by the gap at least: several times
    #: what finite elements leave of an exact field, and a fifth of the stress.
    equilibrium: Threshold = Threshold(0.05, 0.20)
    #: Standard deviation of the stiffness over itself: phases that differ by a fifth are then two of them apart, and
    #: zero stiffness is.
    spread: Threshold = Threshold(0.10, 0.50)
    #: Standard uncertainty of the level of the stress: two of it are a tenth, more than phases that count differ by. A
    #: tenth itself is what one sheet in three is then off by.
    level: Threshold = Threshold(0.05, 0.10)


SETTINGS = Settings()
