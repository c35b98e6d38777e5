"""Stage 2 for a real sheet: folders of frames and force records become a measurement file."""

import numpy as np

from hypernode.config.model import Config
from hypernode.dic.specimen import import_specimen
from hypernode.stages.imported_sheet import attributes_of, variables_of
from hypernode.storage.netcdf import EXPERIMENT_UNITS, sha256, write
from hypernode.synthetic.geometry import make_shape


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Import a specimen: mm, N and MPa, y upward.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    case = config.cases[name]
    specimen = config.specimens[case.specimen]
    sheet = import_specimen(specimen, make_shape(config.geometries[case.hole]) if case.hole else None)
    # Nobody knows where the measured field lies in a real sheet: positions are from its corner.
    corner = np.zeros(2)
    write(
        output,
        variables_of(sheet, corner),
        f"measurement of specimen {specimen.source_title or name}",
        {
            **attributes,
            **attributes_of(specimen, sheet, corner),
            "units": EXPERIMENT_UNITS,
            "load_cases": [each.test.load for each in sheet.cases],
            "raw_inputs": {str(path): sha256(path) for path in sheet.files},
        },
    )
