"""The window of an engine of image correlation, as an identification found it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np
import xarray as xr

#: Name of the attribute that keeps it, in files of identified fields.
KEPT_AS = "believed_window"


@dataclass(frozen=True)
class BelievedWindow:
    """The window through which a field was identified.

    Attributes:
        side: of the window, in the unit of the sheet, over which interpolants between points are averaged. They smooth
            by themselves, so that it is less than an engine's: its square by two squared steps of the grid.
        error: standard deviation of the side, 0 where it is stated.
        texture: share of what the mean over the window changes by which an engine's answer differs from that mean.
    """

    side: float
    error: float
    texture: float

    def of(self, measurement: xr.Dataset) -> xr.Dataset:
        """The measurement as seen through this window.

        What the mean over a window changes grows with the square of its side, and is uncertain by that besides.
        """
        uncertainty = float(np.hypot(self.texture, 2.0 * self.error / self.side))
        changed = {"correlation_window": self.side, "window_uncertainty": uncertainty}
        return measurement.assign_attrs(**changed, **self.stored())

    def stored(self) -> dict[str, str]:
        """As an attribute of a file."""
        return {KEPT_AS: json.dumps(asdict(self))}

    @classmethod
    def read(cls, attributes: Mapping[str, object]) -> "BelievedWindow | None":
        """The one that the attributes of a file or of a changed measurement name, None where they name none."""
        return cls(**json.loads(str(attributes[KEPT_AS]))) if KEPT_AS in attributes else None
