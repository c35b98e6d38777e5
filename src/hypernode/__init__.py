"""Full-field identification of heterogeneous hyperelastic sheets."""


def load_material(path):
    """The material field stored in a result file; see :func:`hypernode.material.files.load_material`."""
    from hypernode.material.files import load_material

    return load_material(path)


__all__ = ["load_material"]
