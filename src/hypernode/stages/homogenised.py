"""Stage 5: one set of neural-ODE parameters for the whole sheet."""

import dataclasses
import json

from hypernode.config.methods import Method
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of
from hypernode.storage.netcdf import read, units_of, write
from hypernode.storage.schema import without_truth
from hypernode.training.homogenised import fit_homogenised


def run(method: Method, name: str, measurement_file: str, field_file: str, output: str, attributes: dict) -> None:
    """Fit the homogenised material of one case and write it."""
    measurement, field = (without_truth(read(path)) for path in (measurement_file, field_file))
    loading = Loading.of(measurement)
    found = fit_homogenised(method, name, mesh_of(measurement), loading, field_gradient(field))
    write(
        output,
        {
            "node_params": found.fit.params,
            "P_average": loading.P_average,
            "P_homogenised": found.P,
            "loss": found.fit.losses,
            "loss_iteration": found.fit.iterations,
        },
        f"homogenised material of {name}",
        {**attributes, "units": units_of(measurement), "node": json.dumps(dataclasses.asdict(found.node))},
        parents=[measurement_file, field_file],
    )
