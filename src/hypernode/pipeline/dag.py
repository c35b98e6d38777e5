"""The graph of the stages: which cases run, which stages a run passes, and which files it shares with others."""

from pathlib import Path

from hypernode.config.model import Config
from hypernode.config.slices import in_fixed_order


def present_cases(config: Config) -> tuple[list[str], list[str]]:
    """(cases that can run, a line for each specimen whose folder and each correlation engine that is absent)."""
    present, absent = [], []
    for name, case in config.cases.items():
        specimen = config.specimens.get(case.specimen) if case.specimen else None
        missing = (
            next((t.folder for t in specimen.all_tests if not Path(t.folder).is_dir()), None) if specimen else None
        )
        if missing is not None:
            source = f"; its data are published in {specimen.published_at}" if specimen.published_at else ""
            absent.append(f"Leaving out {name}: there is no folder {missing}{source}")
        elif case.photographed and (sentence := _missing_engine(case.camera.correlated.engine)):
            absent.append(f"Leaving out {name}: {sentence}")
        else:
            present.append(name)
    return present, absent


def _missing_engine(engine: str) -> str | None:
    """What is missing where the pictures of a case cannot be correlated."""
    # Configurations without pictures need not wait for the packages that read them.
    from hypernode.pictures.correlation import PYTHONS, EngineMissing, python_of

    if engine not in PYTHONS:
        return None
    try:
        python_of(engine)
    except EngineMissing as error:
        return str(error)
    return None


#: Stage -> the parts of a method that it uses, in the order in which the stages follow one another. The first part
#: of the list, to ``pretrained``, is a chain; ``polished``, ``material`` and ``baseline`` are its ends.
STAGE_SETTINGS = {
    "constrained": ("constrained",),
    "gradient": ("gradient",),
    "interpolant": ("interpolant", "normalised", "seed"),
    "homogenised": ("node", "homogenised", "normalised", "seed"),
    "initialised": ("hypernetwork", "initialisation", "seed"),
    "pretrained": ("hypernetwork", "initialisation", "pretraining", "normalised", "prior_weight", "seed"),
    "polished": ("hypernetwork", "constrained", "polish", "seed"),
    "material": ("hypernetwork", "initialisation", "training", "normalised", "prior_weight", "seed"),
    "baseline": ("baseline", "regions", "seed"),
}
#: The stages that train the hyper-network, in their order, and the section of a method with their iterations.
NETWORK_STAGES = {"initialised": "initialisation", "pretrained": "pretraining", "material": "training"}
#: Stages whose file methods share where all that decides it is the same.
SHARED = tuple(STAGE_SETTINGS)[: tuple(STAGE_SETTINGS).index("pretrained") + 1]


def method_settings(config: Config, method: str, stage: str) -> dict:
    """The part of a method that one stage uses, so that an edit of another stage does not rerun it."""
    return in_fixed_order(config.methods[method].model_dump(mode="json", include=set(STAGE_SETTINGS[stage])))


def stage_file(config: Config, case: str, method: str, stage: str) -> str:
    """The result of one stage: that of the case's first method for which it is the same.

    Methods that differ only in later stages share the earlier ones, which are computed once.
    """
    if stage in SHARED:
        keys = {key for earlier in SHARED[: SHARED.index(stage) + 1] for key in STAGE_SETTINGS[earlier]}
        wanted = [getattr(config.methods[method], key) for key in keys]
        same = [m for m in config.cases[case].methods if [getattr(config.methods[m], key) for key in keys] == wanted]
        method = next(iter(same), method)
    if stage == "pretrained" and only_pretrained(config, method):
        stage = "material"
    return f"results/{case}/{method}/{stage}.nc"


def only_pretrained(config: Config, method: str) -> bool:
    """Whether the hyper-network that pre-training leaves is the method's result."""
    settings = config.methods[method]
    if settings.polish:
        return False
    return bool(settings.pretraining and settings.pretraining.iterations and not settings.training.iterations)


def run_stages(config: Config, method: str) -> list[str]:
    """The stages that a run passes up to its material, in their order."""
    settings = config.methods[method]
    fields = ["constrained"] * (settings.constrained is not None) + ["gradient"]
    if settings.baseline:
        return [*fields, "material"]
    before = ["initialised"] if only_pretrained(config, method) else ["initialised", "pretrained"]
    networks = [stage for stage in before if getattr(settings, NETWORK_STAGES[stage]).iterations]
    return [*fields, *["interpolant"] * (settings.interpolant is not None), "homogenised", *networks, "material"]


def sheet_stages(config: Config, case: str) -> list[str]:
    """The stages that a case passes up to its measurement, in their order."""
    if config.cases[case].specimen:
        return ["measurement"]
    pictures = ["speckle", "pictures", "correlated"] if config.cases[case].photographed else []
    return ["true_material", "forward", *pictures, "measurement"]


def run_files(config: Config, case: str, method: str) -> list[str]:
    """Every result that a run leaves or shares, from the sheet to its evaluation."""
    return [
        *(f"results/{case}/{stage}.nc" for stage in sheet_stages(config, case)),
        *(stage_file(config, case, method, stage) for stage in run_stages(config, method)),
        f"results/{case}/{method}/evaluation.nc",
    ]


def run_benchmarks(config: Config, case: str, method: str) -> list[str]:
    """The timing of every job of a run, without those of stages that it shares with another run."""
    settings = config.methods[method]
    rules = {"initialised": "initialisation", "pretrained": "pretraining"}
    rules["material"] = "training"
    if settings.baseline:
        rules["material"] = "baseline"
    elif settings.polish:
        rules["material"] = "polish"
    elif only_pretrained(config, method):
        rules["material"] = "pretraining"
    if config.cases[case].specimen:
        rules["measurement"] = "import_dic"
    elif config.cases[case].photographed:
        rules |= {"pictures": "photograph", "correlated": "correlate", "measurement": "photographed"}
    files = [Path(file).relative_to("results") for file in run_files(config, case, method)]
    own = [file for file in files if file.parts[1:-1] in ((), (method,))]
    return [f"results/benchmarks/{file.parent}/{rules.get(file.stem, file.stem)}.jsonl" for file in own]


def previous_input(config: Config, case: str, method: str, stage: str) -> dict[str, str]:
    """The hyper-network that a stage goes on with, as a named input.

    It is that of the last stage before it that has iterations; where none has, there is none.
    """
    stages = list(NETWORK_STAGES)
    for earlier in reversed(stages[: stages.index(stage)]):
        if getattr(config.methods[method], NETWORK_STAGES[earlier]).iterations:
            return {"previous": stage_file(config, case, method, earlier)}
    return {}


def field_inputs(config: Config, case: str, method: str, *keys: str) -> dict[str, str]:
    """Named inputs of a stage that learns from the deformation field.

    ``field`` is the interpolant, or the gradient where the method has no interpolant; ``constrained``
    is left out where the method has no constrained field.
    """
    settings = config.methods[method]
    stages = {
        "field": "gradient" if settings.interpolant is None else "interpolant",
        "homogenised": "homogenised",
    }
    if settings.constrained is not None:
        stages["constrained"] = "constrained"
    files = {key: stage_file(config, case, method, stage) for key, stage in stages.items()}
    files["measurement"] = f"results/{case}/measurement.nc"
    return {key: files[key] for key in keys if key in files}
