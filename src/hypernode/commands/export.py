"""``hypernode export results/CASE/METHOD``: an identified material as files that other programs read."""

from pathlib import Path

from hypernode.commands.options import UsageError

#: What may be written.
KINDS = {
    "vtu": "fields for ParaView, sheet.vtu, and what they are, sheet.md",
    "numpy": "stress, tangent and energy in Python with NumPy alone, material.py and material.npz",
    "febio": "mesh, material and its parameters in every element for FEBio, sheet.feb",
    "table": "closed-form laws of the phases with standard deviations, laws.md and laws.csv",
}


def add_export(commands) -> None:
    """``export RUN [FOLDER]``."""
    parser = commands.add_parser(
        "export",
        help="write an identified material for other programs: " + "; ".join(f"{k}: {v}" for k, v in KINDS.items()),
    )
    parser.add_argument(
        "run_folder",
        type=Path,
        metavar="RUN",
        help="results/CASE/METHOD; for numpy also a file that holds a material, such as results/CASE/true_material.nc",
    )
    parser.add_argument(
        "folder", type=Path, nargs="?", metavar="FOLDER", help="where to, beside RUN (CASE_METHOD here)"
    )
    parser.add_argument(
        "--to", action="append", choices=tuple(KINDS), help="one kind of files, and another for each more; all if not"
    )
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="the same as FOLDER")
    parser.set_defaults(run=run_export)


def run_export(arguments) -> int:
    """Write the files and print their names."""
    source = arguments.run_folder
    kinds = arguments.to or list(KINDS if source.is_dir() else ["numpy"])
    if arguments.folder and arguments.output:
        raise UsageError(f"--output {arguments.output}: the folder is given twice, {arguments.folder} before")
    if not source.is_dir() and set(kinds) - {"numpy"}:
        raise UsageError(f"{source}: is no folder of a run, results/CASE/METHOD; a file of a material goes --to numpy")
    folder = arguments.folder or arguments.output or Path(_name(source))
    for path in _write(folder, _content(source, kinds)):
        print(path)
    return 0


def _name(source: Path) -> str:
    """CASE_METHOD of a run; CASE and the file's name of a file."""
    path = source.resolve()
    return f"{path.parent.name}_{path.name if path.is_dir() else path.stem}"


def _content(source: Path, kinds: list[str]) -> dict[str, bytes]:
    """{name: content} of the files of all kinds."""
    import jax

    from hypernode.export.febio import febio_files
    from hypernode.export.numpy_package import numpy_package
    from hypernode.export.table import phase_laws, table_files
    from hypernode.export.vtu import vtu_files

    # Coefficients are written, and stresses computed, in double precision.
    jax.config.update("jax_enable_x64", True)
    files: dict[str, bytes] = {}
    if "numpy" in kinds:
        files |= numpy_package(_read_material(source / "material.nc" if source.is_dir() else source))
    if set(kinds) == {"numpy"}:
        return files
    run = open_run(source)
    if run.plane == "strain" and {"febio", "table"} & set(kinds):
        raise UsageError(
            f"{source}: is identified in plane strain, and closed-form laws of febio and table are of plane stress; "
            "write --to numpy --to vtu"
        )
    if "vtu" in kinds:
        files |= vtu_files(run)
    if {"febio", "table"} & set(kinds):
        laws = phase_laws(run)
        files |= febio_files(run, laws) if "febio" in kinds else {}
        files |= table_files(run, laws) if "table" in kinds else {}
    return files


def _read_material(path: Path):
    """An opened file that holds a material.

    Raises:
        StorageError: it is missing or damaged, or holds none.
    """
    from hypernode.storage.netcdf import StorageError, read

    file = read(path)
    if "material_kind" not in file.attrs:
        raise StorageError(f"{path}: holds no material; name a run, or its material.nc")
    return file


def open_run(folder: Path):
    """The opened files of a run: its evaluation, and what that was computed from.

    Raises:
        StorageError: a file is missing or damaged.
        VerdictError: the evaluation is of an older version.
    """
    from hypernode.export.run import Run
    from hypernode.storage.netcdf import read
    from hypernode.storage.run_files import run_files
    from hypernode.tables.verdicts import RunVerdict

    paths = run_files(folder)
    needed = ("evaluation", "material", "measurement", "constrained")
    files = {name: read(paths[name]) for name in needed if name in paths}
    files["field"] = read(paths["interpolant" if "interpolant" in paths else "gradient"])
    return Run(RunVerdict.of(files["evaluation"], str(paths["evaluation"])).run, files)


def _write(folder: Path, files: dict[str, bytes]) -> list[Path]:
    """Write files into a folder, or none where one of them is there.

    Raises:
        UsageError: one of them is there already.
    """
    paths = [folder / name for name in files]
    there = [str(path) for path in paths if path.exists()]
    if there:
        raise UsageError(f"{', '.join(there)}: would be overwritten; name another folder, or delete it")
    folder.mkdir(parents=True, exist_ok=True)
    for path, content in zip(paths, files.values(), strict=True):
        path.write_bytes(content)
    return paths
