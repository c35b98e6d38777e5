"""How XLA compiles what a job computes, and in which precision."""

import importlib.metadata
import os
import sys
from pathlib import Path

from hypernode.storage.environment import instruction_set

#: XLA's older emitters of CPU kernels (docs/decisions/0016). A step of ours is hundreds of small kernels. The newer
#: emitters set up a compiler of their own for each, which takes longer than what they save in all but the longest
#: training.
QUICK_KERNELS = "--xla_cpu_use_fusion_emitters=false"
#: Rules whose jobs solve for a whole sheet at once; training and all that only evaluates compute in single precision.
DOUBLE_PRECISION = frozenset({"forward", "constrained", "baseline", "validation", "references", "population_batch"})


def rule_settings(rule: str) -> dict[str, str]:
    """:func:`compiler_settings` of the jobs of a rule."""
    return compiler_settings(rule in DOUBLE_PRECISION)


def compiler_settings(float64: bool) -> dict[str, str]:
    """Environment variables of a job that can change its numbers. Where ``XLA_FLAGS`` is set, it has the last word.

    Args:
        float64: whether JAX computes in double precision.
    """
    given = os.environ.get("XLA_FLAGS", "")
    return {
        "XLA_FLAGS": given if given.startswith(QUICK_KERNELS) else f"{QUICK_KERNELS} {given}".strip(),
        "JAX_ENABLE_X64": str(int(float64)),
        "JAX_PLATFORMS": os.environ.get("JAX_PLATFORMS", "cpu"),
    }


def set_up_compiler(float64: bool) -> None:
    """Compile quickly, and keep what is compiled between jobs, outside results/ and safe to delete at any time.

    Call it before JAX computes anything; a job that never does need not import it.

    Args:
        float64: whether JAX computes in double precision.
    """
    # What one processor compiled may stop another one, of the same cluster, at an instruction that it lacks.
    version = f"jax-{importlib.metadata.version('jaxlib')}-{instruction_set()}"
    folder = Path(os.environ.get("HYPERNODE_CACHE", ".cache")) / version
    # With that, XLA's complaint on every load from the cache is false: it takes what LLVM prefers to avoid for
    # instructions that the processor lacks (openxla/xla 44565). What does stop a job is an exception in any case.
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    settings = {
        **compiler_settings(float64),
        "JAX_COMPILATION_CACHE_DIR": str(folder.resolve()),
        # Most of a job's compilation is a hundred small functions; kept, they cost a few milliseconds each.
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
    os.environ |= settings
    if "jax" in sys.modules:
        _set_up_imported(settings)


def _set_up_imported(settings: dict[str, str]) -> None:
    """The same for a JAX that has been imported, and has read the environment of its time."""
    import jax

    for variable, value in settings.items():
        name = variable.lower()
        if name.startswith("jax_"):
            kind = type(getattr(jax.config, name))
            numbers = {bool: lambda text: bool(int(text)), int: int, float: float}
            jax.config.update(name, numbers.get(kind, str)(value))
