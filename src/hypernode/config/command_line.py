"""The configuration that a run of Snakemake is given: the default file, or ``--configfile``, and ``--config``."""

from pathlib import Path

from hypernode.config.loading import check_config, load_config
from hypernode.config.model import Config

#: How YAML 1.2 writes null; Snakemake leaves everything inside the mappings of ``--config`` as text.
_NULL = ("null", "Null", "NULL", "~", "")


def run_config(workflow, config: dict, default: Path) -> Config:
    """Read the configuration of a run, so that errors name the file and line of a value, or ``--config``.

    Files of the command line replace the default one, whose cases would otherwise run too; ``--config`` is
    laid over either.

    Args:
        workflow: Snakemake's workflow.
        config: Snakemake's merged configuration, used where another version does not tell where it is from.
        default: the file that is read where the command line names none.

    Raises:
        ConfigError: see :func:`load_config`.
    """
    settings = getattr(workflow, "config_settings", None)
    files = getattr(settings, "configfiles", None)
    overrides = getattr(settings, "config", None)
    if files is None or overrides is None:
        return check_config(dict(config), "--configfile, --config") if config else load_config(default)
    return load_config(*(map(_shown, files or [default])), overrides=_with_nulls(dict(overrides)))


def _shown(path: Path) -> Path:
    """A path as short as it is from the working directory."""
    path = Path(path)
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


def _with_nulls(value):
    if isinstance(value, dict):
        return {key: _with_nulls(inner) for key, inner in value.items()}
    return None if isinstance(value, str) and value in _NULL else value


def configuration_files(workflow) -> list[str]:
    """Names of the files of a run's configuration, and ``--config`` where it has any."""
    settings = getattr(workflow, "config_settings", None)
    names = [Path(file).name for file in getattr(settings, "configfiles", None) or ["config.yaml"]]
    return [*names, *(["--config"] if getattr(settings, "config", None) else [])]
