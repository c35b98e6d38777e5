"""How much the last digits decide: a case identified again where nothing but rounding has changed.

The constrained field of each case, in a process of its own, as it is; with two other settings of the compiler, which
order sums differently, as another processor does; with a measurement that is off by 1e-12 of itself; and with one that
is off by as much with another sign. The stress error is that of the field under the load that was tested.

Usage: python benchmarks/disturbances.py [--config config/config.yaml] [--method hypernode] CASE ...
Forward problems and measurements are taken from results/, where `snakemake --cores 2 results/CASE/true_material.nc
results/CASE/measurement.nc` puts them.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

#: Name -> (flags of XLA, relative change of the measurement, seed of its signs).
DISTURBANCES = {
    "as it is": ("", 0.0, 0),
    "no fast minimum and maximum": ("--xla_cpu_enable_fast_min_max=false", 0.0, 0),
    "AVX instead of what there is": ("--xla_cpu_max_isa=AVX", 0.0, 0),
    "measurement off by 1e-12": ("", 1e-12, 1),
    "off by 1e-12, other signs": ("", 1e-12, 2),
}
#: Share of the median, and error, by which an error may differ from it.
SHARE, ERROR = 0.2, 0.002


def once(given) -> None:
    """Identify one case in this process and print its stress error, how it ended, and its misfit, as JSON."""
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    import numpy as np
    import xarray as xr

    from hypernode.config.loading import load_config
    from hypernode.data.measurement import mesh_of
    from hypernode.evaluation.probes import stress_at_common_F
    from hypernode.evaluation.scores import relative_error
    from hypernode.evaluation.truth import observed_mode
    from hypernode.material.files import material_of
    from hypernode.mechanics.modes import mode_gradients
    from hypernode.stages import constrained
    from hypernode.storage.netcdf import read

    config, root = load_config(given["config"]), Path(given["results"]) / given["case"]
    measurement, truth = read(root / "measurement.nc"), read(root / "true_material.nc")
    signs = np.random.default_rng(given["seed"]).choice([-1.0, 1.0], measurement["u_measured"].shape)
    measurement["u_measured"] = measurement["u_measured"] * (1.0 + given["relative"] * signs)
    with tempfile.TemporaryDirectory() as folder:
        changed, output = Path(folder) / "measurement.nc", Path(folder) / "constrained.nc"
        measurement.to_netcdf(changed)
        settings = config.methods[given["method"]].constrained
        constrained.run(settings, given["case"], str(changed), str(output), {"rule": "benchmark"})
        with xr.open_dataset(output) as found:
            mesh, case = mesh_of(measurement), config.cases[given["case"]]
            stretches = np.array(case.judged_stretches or np.unique(measurement["stretch"].values))
            mode = observed_mode(config.loads[case.loads[0]].kind)
            F = mode_gradients(stretches)[mode : mode + 1]
            stresses = [stress_at_common_F(material_of(each), mesh.centres, F)[0] for each in (found, truth)]
            result = {"error": relative_error(*stresses, mesh.areas), "ending": found.attrs["ending"]}
            print(json.dumps(result | {"misfit": json.loads(found.attrs["misfits"])["displacement"]}))


def main() -> int:
    """Print a table; the exit code is 1 where an error differs from the median by more than is allowed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="+", metavar="CASE")
    parser.add_argument("--config", default="config/config.yaml")
    parser.add_argument("--results", default="results")
    parser.add_argument("--method", default="hypernode")
    given = parser.parse_args()
    scattered = False
    for case in given.cases:
        errors = []
        for name, (flags, relative, seed) in DISTURBANCES.items():
            task = {"case": case, "relative": relative, "seed": seed, **vars(given)}
            environment = os.environ | {"XLA_FLAGS": f"{os.environ.get('XLA_FLAGS', '')} {flags}".strip()}
            command = [sys.executable, __file__, "--once", json.dumps(task)]
            run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
            if run.returncode:
                print(f"{case}, {name}: {run.stderr.strip().splitlines()[-1]}", file=sys.stderr)
                return 2
            found = json.loads(run.stdout.splitlines()[-1])
            errors.append(found["error"])
            print(
                f"{case:16} {name:32} {found['error']:.4f}  misfit {found['misfit']:.3f}  {found['ending']}", flush=True
            )
        median = sorted(errors)[len(errors) // 2]
        worst = max(abs(error - median) for error in errors)
        scattered |= worst > max(SHARE * median, ERROR)
        print(f"{case:16} median {median:.4f}, largest distance {worst:.4f}, allowed {max(SHARE * median, ERROR):.4f}")
    return int(scattered)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--once"]:
        once(json.loads(sys.argv[2]))
    else:
        sys.exit(main())
