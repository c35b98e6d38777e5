"""A real test needs few lines: what is left out has a default, and an absent folder is an error unless it may be."""

import numpy as np
import pytest

from hypernode.config.loading import ConfigError, check_config, load_config
from hypernode.config.slices import from_slice, slice_for
from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.frames import select_frames
from hypernode.dic.series import Frame, Series
from hypernode.pipeline.dag import present_cases
from hypernode.pipeline.shown import explored_runs, figure_inputs, figure_runs
from hypernode.pipeline.sources import specimen_files
from tests.dic.test_davis import write_frame

LINES = """specimens:
  mine: {folder: FOLDER, width: 40, height: 40, thickness: 2, pixel_size: 0.0414, frame_rate: 5}
"""
SIZES = {"width": 40, "height": 40, "thickness": 2, "pixel_size": 0.0414, "frame_rate": 5}


def specimen(**settings):
    return Specimen.model_validate({"folder": "f", **SIZES, **settings})


def test_two_lines_are_a_whole_configuration(tmp_path):
    for number, stretch in ((1, 1.0), (2, 1.1)):
        write_frame(tmp_path, number, stretch)
    file = tmp_path / "c.yaml"
    file.write_text(LINES.replace("FOLDER", str(tmp_path)))
    config = load_config(file)
    assert present_cases(config) == (["mine"], [])
    assert config.cases["mine"].methods == ["hypernode"] and config.cases["mine"].specimen == "mine"
    figures = figure_runs(config, ["mine"])
    assert [(f.kind, f.case, f.method) for f in figures.values()] == [("identification", "mine", "hypernode")]
    assert explored_runs(config, ["mine"]) == {("mine", "hypernode"): None}
    assert figure_inputs(config, "mine_hypernode") == {"evaluation": "results/mine/hypernode/evaluation.nc"}
    assert specimen_files(config, "mine")[-1] == str(tmp_path / "force_disp.csv")


def test_figures_that_are_written_are_all_there_are(tmp_path):
    raw = {"specimens": {"mine": {"folder": str(tmp_path), **SIZES}}, "figures": {}, "explorers": []}
    assert check_config(raw).figures == {} and check_config(raw).explorers == []


def test_a_specimen_that_a_case_names_is_no_further_case(tmp_path):
    raw = {"specimens": {"s": {"folder": str(tmp_path), **SIZES}}, "cases": {"c": {"specimen": "s"}}}
    assert set(check_config(raw).cases) == {"c"}
    raw["specimens"]["c"] = raw["specimens"]["s"]
    with pytest.raises(ConfigError, match=r"specimens\.c: no case names it.*add a case with 'specimen: c'"):
        check_config(raw)


def test_an_absent_folder_is_an_error_with_its_line_unless_it_may_be_absent(tmp_path):
    file = tmp_path / "c.yaml"
    text = LINES.replace("FOLDER", "nowhere, published_at: repository a/b")
    file.write_text(text)
    with pytest.raises(ConfigError, match=r"c\.yaml:2: specimens\.mine\.folder = 'nowhere': .*a/b.*'optional: true'"):
        load_config(file)
    file.write_text(text.replace("nowhere", "nowhere, optional: true"))
    config = load_config(file)
    left_out = "Leaving out mine: there is no folder nowhere; its data are published in repository a/b"
    assert present_cases(config) == ([], [left_out])
    assert figure_runs(config, []) == {}


@pytest.mark.parametrize("pair", [("frames", "stretches"), ("stretches", "load_steps"), ("frames", "load_steps")])
def test_only_one_thing_selects_the_load_steps(pair):
    values = {"frames": [2], "stretches": [1.1], "load_steps": 3}
    with pytest.raises(ValueError, match=f"give only one of {pair[0]}, {pair[1]}:"):
        specimen(**{key: values[key] for key in pair})


def test_the_selection_survives_the_slice_that_the_import_sees(tmp_path):
    config = check_config({"specimens": {"mine": {"folder": str(tmp_path), **SIZES}}})
    part = from_slice(slice_for(config, "mine", ("specimens",), keys=("specimen",)))
    assert part.specimens["mine"] == config.specimens["mine"] and part.specimens["mine"].load_steps == 5


def series(stretches):
    """Frames of a uniformly pulled sheet, numbered from 1."""
    y, x = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    frames = [Frame(k, np.stack([0 * x, (s - 1) * y], axis=-1)) for k, s in enumerate(stretches, start=1)]
    return Series(np.arange(3.0), np.arange(4.0), frames)


def test_load_steps_are_evenly_spaced_in_stretch_up_to_the_largest():
    stretches = 1.0 + 0.2 * (np.arange(21) / 20) ** 2
    chosen = select_frames(specimen(), series([*stretches, 1.12, 1.0]))
    np.testing.assert_allclose(stretches[chosen - 1], 1.0 + 0.04 * np.arange(1, 6), atol=0.011)
    assert chosen[-1] == 21


def test_a_short_series_gives_each_of_its_frames_once():
    assert select_frames(specimen(), series([1.0, 1.05, 1.1])).tolist() == [2, 3]
    assert select_frames(specimen(load_steps=1), series([1.0, 1.05, 1.1])).tolist() == [3]


def test_a_sheet_that_is_never_pulled_is_refused():
    with pytest.raises(DicError, match="in no frame is the sheet longer"):
        select_frames(specimen(), series([1.0, 0.99, 1.0]))


def test_a_sheet_whose_thickness_stays_needs_a_law_whose_area_has_an_energy(tmp_path):
    raw = {"specimens": {"thick": {"folder": str(tmp_path), **SIZES, "plane": "strain"}}}
    with pytest.raises(ConfigError, match=r"hypernode has a law of a thin sheet.*take hypernode_compressible"):
        check_config(raw)
    raw["cases"] = {"thick": {"specimen": "thick", "methods": ["hypernode_compressible"]}}
    assert check_config(raw).specimens["thick"].plane == "strain"
