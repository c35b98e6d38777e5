"""What a job's log says of its time: each second once, and read back as it was written."""

import time

import jax
import jax.numpy as jnp
import pytest

from hypernode.pipeline.phases import Phases, read_line


def test_what_is_traced_within_a_trace_is_counted_once():
    phases = Phases()
    time.sleep(0.06)
    phases.heard("/jax/core/compile/jaxpr_trace_duration", 0.01)
    phases.heard("/jax/core/compile/jaxpr_trace_duration", 0.03)
    phases.heard("/jax/core/compile/backend_compile_duration", 0.0)
    phases.heard("/jax/some/other_duration", 9.0)
    found = phases.seconds()
    assert found["tracing"] == pytest.approx(0.03)
    assert found["rest"] == pytest.approx(0.03, abs=0.02)


def test_a_job_hears_what_it_compiles():
    phases = Phases().listen()
    jax.jit(lambda x: jnp.sin(x) + 3.0)(jnp.ones(7)).block_until_ready()
    found = phases.seconds()
    assert found["tracing"] > 0 and found["compilation"] > 0


def test_the_line_of_a_log_is_read_back():
    phases = Phases()
    phases.heard("/jax/core/compile/backend_compile_duration", 1.25)
    said = read_line(f"[training] X: step 3/3\n{phases.line()}\n")
    assert said == {"tracing": 0.0, "compilation": 1.25, "rest": pytest.approx(0.0, abs=0.2)}
    assert read_line("[training] X: step 3/3\n") is None
