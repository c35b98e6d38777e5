"""What can change a number is recorded: packages, flags, precision."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hypernode.pipeline.compiler import (
    DOUBLE_PRECISION,
    ONE_ORDER,
    QUICK_KERNELS,
    TRAINING,
    compiler_settings,
    rule_settings,
)
from hypernode.storage.environment import NOT_COMPUTING, versions
from hypernode.storage.provenance import modules_used

ROOT = Path(__file__).resolve().parents[2]


def test_every_required_package_that_computes_is_recorded_with_its_pinned_version():
    pinned = dict(re.findall(r"^([\w.-]+)==(\S+)$", (ROOT / "requirements.txt").read_text(), re.MULTILINE))
    assert versions() == {name: pinned[name] for name in pinned if name not in NOT_COMPUTING}
    assert {"jax", "jaxlib", "numpy", "scipy", "cvxopt", "scikit-image", "pillow", "matplotlib"} <= set(versions())
    assert not NOT_COMPUTING & set(versions()) and set(pinned) >= NOT_COMPUTING


@pytest.mark.parametrize("float64", [True, False])
def test_a_job_records_the_flags_and_the_precision_that_it_sets(float64):
    code = "import hypernode.pipeline.compiler as c, hypernode.storage.environment as e; "
    code += f"c.set_up_compiler({float64}); c.set_up_compiler({float64}); print(e.compiler())"
    environment = {**os.environ, "XLA_FLAGS": "--xla_mine=true"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    flags = f"{QUICK_KERNELS} --xla_mine=true"
    wanted = {"XLA_FLAGS": flags, "JAX_ENABLE_X64": str(int(float64)), "JAX_PLATFORMS": "cpu"}
    assert done.stdout.strip() == str(wanted)


def test_rules_in_double_precision_are_rules_whose_finite_elements_need_it():
    """A name that no rule has would leave its jobs in single precision, which the solver refuses."""
    rules = set(re.findall(r"^rule (\w+):", "\n".join(p.read_text() for p in ROOT.glob("workflow/rules/*.smk")), re.M))
    assert rules >= DOUBLE_PRECISION
    assert rule_settings("forward", {}) == compiler_settings(True)
    assert rule_settings("training", {}) == rule_settings("only_pretraining", {}) == compiler_settings(False)
    solving = {p.stem for p in ROOT.glob("workflow/scripts/*.py") if "fem/solver.py" in str(modules_used(p))}
    assert solving <= DOUBLE_PRECISION


def test_what_trained_on_another_platform_is_compared_with_what_that_platform_would_set_now():
    on_cuda = compiler_settings(False, "cuda")
    assert on_cuda["JAX_PLATFORMS"] == "cuda" and on_cuda["XLA_FLAGS"].startswith(f"{QUICK_KERNELS} {ONE_ORDER}")
    assert rule_settings("training", on_cuda) == on_cuda
    assert rule_settings("forward", on_cuda) == compiler_settings(True)


def test_the_rules_that_a_platform_is_for_are_told_it_and_no_others():
    text = "\n".join(path.read_text() for path in ROOT.glob("workflow/rules/*.smk"))
    rules = re.split(r"^(?:use )?rule (\w+)", text, flags=re.MULTILINE)[1:]
    told = {name for name, body in zip(rules[::2], rules[1::2], strict=True) if "platform=CONFIG.platform" in body}
    assert told | {"only_pretraining"} == TRAINING
