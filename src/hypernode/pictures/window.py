"""Through which window an engine sees a displacement field."""

from hypernode.config.correlation import Correlation

#: (engine, shape of its subsets) -> (kernel, its side over the subset), as `benchmarks/correlation_transfer.py` has
#: measured them with subsets of 15 to 31 pixels, between which they vary by 0.02, 0.1 and 0.03 (docs/decisions/0046).
WINDOWS = {
    ("pyvale", "affine"): ("average", 0.98),
    ("pyvale", "quadratic"): ("quadratic", 1.05),
    ("al_dic", "affine"): ("average", 0.98),
    # Displacements of the shape functions themselves: no window lies between.
    ("finite_elements", "affine"): ("average", 0.0),
}


def window_of(settings: Correlation) -> tuple[float, str]:
    """(side of the window [pixel], its kernel: ``average``, or ``quadratic`` for the middle of a quadratic fit)."""
    kernel, share = WINDOWS[settings.engine, settings.shape]
    return share * settings.subset, kernel
