"""Full-field identification of heterogeneous hyperelastic sheets."""


def load_material(path):
    """The material field that a result file holds, identified or true.

    It answers ``stress(X, F)``, ``energy(X, F)`` and ``tangent(X, F)`` for positions X (point, 2) and in-plane
    deformation gradients F (point, 2, 2). Its ``units`` say what the numbers mean.

    Args:
        path: ``material.nc`` or ``constrained.nc`` of a run, or ``true_material.nc`` of a synthetic case.

    Raises:
        StorageError: the file is missing, damaged, or holds no material.
    """
    from hypernode.material.files import load_material

    return load_material(path)


__all__ = ["load_material"]
