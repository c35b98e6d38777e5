"""How XLA compiles what a job computes, in which precision, and for which platform."""

import importlib.metadata
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from hypernode.errors import ExpectedError
from hypernode.storage.environment import instruction_set

#: XLA's older emitters of CPU kernels (docs/decisions/0016). A step of ours is hundreds of small kernels. The newer
#: emitters set up a compiler of their own for each, which takes longer than what they save in all but the longest
#: training.
QUICK_KERNELS = "--xla_cpu_use_fusion_emitters=false"
#: Rules whose jobs solve for a whole sheet at once; training and all that only evaluates compute in single precision.
DOUBLE_PRECISION = frozenset(
    {"forward", "constrained", "polish", "baseline", "validation", "references", "population_batch"}
)
#: Rules whose jobs train networks: what the ``platform`` of a configuration is for. All others compute on the CPU, as
#: sparse factors do.
TRAINING = frozenset({"interpolant", "homogenised", "initialisation", "pretraining", "only_pretraining", "training"})
#: Sums of a GPU in one order, so that a run again gives the same bytes.
ONE_ORDER = "--xla_gpu_deterministic_ops=true"


class PlatformMissing(ExpectedError, RuntimeError):
    """The configuration asks for a platform that is not here; the message says the way out."""


def rule_settings(rule: str, recorded: Mapping[str, str]) -> dict[str, str]:
    """:func:`compiler_settings` of the jobs of a rule now, on the platform on which a recorded one has trained.

    Args:
        rule: name.
        recorded: those of a job of the past.
    """
    platform = recorded.get("JAX_PLATFORMS", "cpu") if rule in TRAINING else "cpu"
    return compiler_settings(rule in DOUBLE_PRECISION, platform)


def compiler_settings(float64: bool, platform: str = "cpu") -> dict[str, str]:
    """Environment variables of a job that can change its numbers. Where ``XLA_FLAGS`` is set, it has the last word.

    Args:
        float64: whether JAX computes in double precision.
        platform: ``cpu`` or ``cuda``; of the former ``JAX_PLATFORMS`` has the last word.
    """
    given = os.environ.get("XLA_FLAGS", "")
    flags = f"{QUICK_KERNELS} {ONE_ORDER}" if platform == "cuda" else QUICK_KERNELS
    return {
        "XLA_FLAGS": given if given.startswith(flags) else f"{flags} {given}".strip(),
        "JAX_ENABLE_X64": str(int(float64)),
        "JAX_PLATFORMS": platform if platform != "cpu" else os.environ.get("JAX_PLATFORMS", "cpu"),
    }


def require_platform(platform: str) -> None:
    """Look whether a platform is here. Call it once the compiler is set up for it.

    Raises:
        PlatformMissing: JAX has no device of it, or lacks what it needs for it.
    """
    asked = os.environ.get("JAX_PLATFORMS", "")
    if platform == "cpu" and asked in ("", "cpu"):
        return
    import jax

    try:
        jax.devices()
    # JAX asserts, without a word, that it knows the platform at all.
    except (RuntimeError, AssertionError) as error:
        said = f" ({str(error).splitlines()[0]})" if str(error) else ""
        if platform == "cpu":
            raise PlatformMissing(
                f"JAX_PLATFORMS={asked}: JAX finds no such device here{said}: unset the variable, or set it to cpu"
            ) from None
        raise PlatformMissing(
            f"platform: {platform}: JAX finds no such device here{said}; where there is one, "
            "pip install -r requirements/gpu.txt, and elsewhere say 'platform: cpu' in the configuration"
        ) from None


def set_up_compiler(float64: bool, platform: str = "cpu") -> None:
    """Compile quickly, and keep what is compiled between jobs, outside results/ and safe to delete at any time.

    Call it before JAX computes anything; a job that never does need not import it.

    Args:
        float64: whether JAX computes in double precision.
        platform: ``cpu`` or ``cuda``.
    """
    # What one processor compiled may stop another one, of the same cluster, at an instruction that it lacks.
    version = f"jax-{importlib.metadata.version('jaxlib')}-{instruction_set()}"
    folder = Path(os.environ.get("HYPERNODE_CACHE", ".cache")) / version
    # With that, XLA's complaint on every load from the cache is false: it takes what LLVM prefers to avoid for
    # instructions that the processor lacks (openxla/xla 44565). What does stop a job is an exception in any case.
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    settings = {
        **compiler_settings(float64, platform),
        "JAX_COMPILATION_CACHE_DIR": str(folder.resolve()),
        # Most of a job's compilation is a hundred small functions; kept, they cost a few milliseconds each.
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
    if platform == "cuda":
        # Jobs side by side share one device, of which JAX would take three quarters for the first.
        os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
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
