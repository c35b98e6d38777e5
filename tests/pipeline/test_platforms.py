"""A platform that is asked for and not there is said in a sentence, wherever it was asked for."""

import jax
import pytest

from hypernode.pipeline.compiler import PlatformMissing, require_platform


@pytest.mark.parametrize(
    ("platform", "variable", "words"),
    [("cpu", "cuda", "JAX_PLATFORMS=cuda: .*unset the variable"), ("cuda", "", "platform: cuda: .*platform: cpu")],
)
def test_a_missing_device_names_what_asked_for_it_and_the_way_out(monkeypatch, platform, variable, words):
    def none_here():
        raise AssertionError

    monkeypatch.setenv("JAX_PLATFORMS", variable)
    monkeypatch.setattr(jax, "devices", none_here)
    with pytest.raises(PlatformMissing, match=words):
        require_platform(platform)


@pytest.mark.parametrize("variable", ["", "cpu"])
def test_without_a_device_asked_for_nothing_is_looked_for(monkeypatch, variable):
    monkeypatch.setenv("JAX_PLATFORMS", variable)
    monkeypatch.setattr(jax, "devices", None)
    assert require_platform("cpu") is None
