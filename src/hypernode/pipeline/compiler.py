"""How XLA compiles what a job computes, and in which precision."""

import ast
import importlib.metadata
import os
import re
from pathlib import Path

#: XLA's older emitters of CPU kernels (docs/decisions/0016). A step of ours is hundreds of small kernels. The newer
#: emitters set up a compiler of their own for each, which takes longer than what they save in all but the longest
#: training.
QUICK_KERNELS = "--xla_cpu_use_fusion_emitters=false"


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

    Call it before JAX is imported, which many jobs never do.

    Args:
        float64: whether JAX computes in double precision.
    """
    folder = Path(os.environ.get("HYPERNODE_CACHE", ".cache")) / f"jax-{importlib.metadata.version('jaxlib')}"
    os.environ |= {
        **compiler_settings(float64),
        "JAX_COMPILATION_CACHE_DIR": str(folder.resolve()),
        # Most of a job's compilation is a hundred small functions; kept, they cost a few milliseconds each.
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }


def settings_of_rules(workflow: Path) -> dict[str, dict[str, str]]:
    """What the job of each rule would set now, by the call of ``job`` in its script.

    Args:
        workflow: folder with ``scripts`` and ``rules``.
    """
    settings = {}
    for script in sorted(workflow.glob("scripts/*.py")):
        calls = [node for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)]
        words = [word for call in calls if getattr(call.func, "id", "") == "job" for word in call.keywords]
        settings[script.stem] = compiler_settings(any(w.arg == "float64" and ast.literal_eval(w.value) for w in words))
    for rules in sorted(workflow.glob("rules/*.smk")):
        for rule, other in re.findall(r"^use rule (\w+) as (\w+)", rules.read_text(encoding="utf-8"), re.MULTILINE):
            settings[other] = settings[rule]
    return settings
