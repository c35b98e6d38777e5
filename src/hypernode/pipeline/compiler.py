"""How one job compiles: the flags of XLA, the precision of JAX, and where compiled functions are kept."""

import importlib.metadata
import os
from pathlib import Path

#: XLA's older emitters of CPU kernels (docs/decisions/0016).
QUICK_KERNELS = "--xla_cpu_use_fusion_emitters=false"


def set_up_compiler(float64: bool) -> None:
    """Compile quickly, and keep what is compiled between jobs, outside results/ and safe to delete at any time.

    Call it before JAX is imported, which many jobs never do. Where ``XLA_FLAGS`` is set, it has the last word.

    Args:
        float64: whether JAX computes in double precision.
    """
    folder = Path(os.environ.get("HYPERNODE_CACHE", ".cache")) / f"jax-{importlib.metadata.version('jaxlib')}"
    os.environ |= {
        # A step of ours is hundreds of small kernels. The newer emitters set up a compiler of their own for each, which
        # takes longer than what they save in all but the longest training.
        "XLA_FLAGS": " ".join(filter(None, [QUICK_KERNELS, os.environ.get("XLA_FLAGS")])),
        "JAX_ENABLE_X64": str(int(float64)),
        "JAX_COMPILATION_CACHE_DIR": str(folder.resolve()),
        # Most of a job's compilation is a hundred small functions; kept, they cost a few milliseconds each.
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
