"""Which noise of displacements an identification believed: that of the measurement, or what speaks against it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum

import xarray as xr

#: Name of the attribute that keeps it, in files of identified fields.
KEPT_AS = "believed_noise"


class NoiseSource(StrEnum):
    """Where a noise is from."""

    #: As the measurement says, by the configuration or by its frames.
    MEASUREMENT = "measurement"
    #: The same, no error of which is shared by points or steps.
    INDEPENDENT = "independent errors"
    #: What the frames tell, against what the configuration says.
    FRAMES = "frames"


@dataclass(frozen=True)
class BelievedNoise:
    """The noise with which a field was identified.

    Attributes:
        source: where it is from.
        factor: of all its levels.
    """

    source: NoiseSource = NoiseSource.MEASUREMENT
    factor: float = 1.0

    @property
    def shared_by_none(self) -> bool:
        """Whether no error is shared by points or steps."""
        return self.source is NoiseSource.INDEPENDENT

    def of(self, measurement: xr.Dataset) -> xr.Dataset:
        """The measurement with this noise in place of its own."""
        scatter, level = measurement["noise_scatter"], measurement["noise_level"]
        if self.shared_by_none:
            level = scatter
        elif self.source is NoiseSource.FRAMES:
            scatter, level = measurement["frames_noise_scatter"], measurement["frames_noise_level"]
        changed = measurement.assign(noise_scatter=self.factor * scatter, noise_level=self.factor * level)
        return changed.assign_attrs(self.stored())

    def __str__(self) -> str:
        return (
            f"that of the {self.source}" if self.factor == 1.0 else f"{self.factor:.2g} times that of the {self.source}"
        )

    def stored(self) -> dict[str, str]:
        """As an attribute of a file."""
        return {KEPT_AS: json.dumps(asdict(self))}

    @classmethod
    def read(cls, attributes: Mapping[str, object]) -> "BelievedNoise":
        """The one that the attributes of a file or of a changed measurement name."""
        if KEPT_AS not in attributes:
            return cls()
        stored = json.loads(str(attributes[KEPT_AS]))
        return cls(NoiseSource(stored["source"]), float(stored["factor"]))
