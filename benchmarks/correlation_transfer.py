"""What each engine of image correlation makes of waves: gain, kernel, side of its window, noise and how far it reaches.

`python benchmarks/correlation_transfer.py [ENGINE,SHAPE,SUBSET ...]`: seconds to a minute each.
"""

import sys

from hypernode.config.correlation import Correlation
from hypernode.config.pictures import Pictures
from hypernode.pictures.transfer import WAVELENGTHS, measured
from hypernode.pictures.window import WINDOWS

ASKED = [argument.split(",") for argument in sys.argv[1:]] or [(*each, "21") for each in WINDOWS]
RATIOS = " ".join(f"{ratio:5.2f}" for ratio in WAVELENGTHS)
print(f"engine  shape      subset  {RATIOS}  kernel    side          noise  length")
for engine, shape, subset in ASKED:
    found = measured(Correlation(engine=engine, shape=shape, subset=int(subset), step=8, reach=40), Pictures())
    gains = " ".join(f"{gain:5.3f}" for gain in found.gain)
    print(
        f"{engine:7} {shape:10} {subset:>6}  {gains}  {found.kernel:9} {found.width:.3f}+-{found.width_error:.3f}  "
        f"{found.noise:.4f} {found.noise_length:6.1f}",
        flush=True,
    )
