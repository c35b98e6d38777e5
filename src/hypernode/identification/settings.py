"""Every constant of the strategy by which a field is identified, each with its reason.

What a user may want to change for a test stands in the configuration (:class:`hypernode.config.methods.Constrained`).
What is here follows from the mathematics, from finite-element errors, or from what was seen to work on many sheets.
"""

from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class Strategy:
    """Constants of the identification of a constrained field."""

    # Data. Displacements are never trusted beyond these shares of the largest one, noise apart: what finite elements
    # on the measured grid make of a field that was computed on that same grid, of one that was observed, whose
    # interfaces lie anywhere, and of the latter where cells are divided into subcells.
    same_grid_floor: float = 3.8e-5
    #: Of fields on a grid of their own, times the number of cells along a side.
    cut_cells_floor: float = 0.065
    subcells_floor: float = 0.01
    #: Misfit of the forces of one load case by the closest homogeneous material beyond which no sheet can have given
    #: them. Ogden, Gent and Fung sheets are missed by 7 % at most, heterogeneous ones by 3 %; a record that is
    #: constant by a quarter, one that is reversed, in another order or tenfold from a step on by more than a third.
    impossible_forces: float = 0.2
    #: Share of a step's largest force below which a component's relative uncertainty no longer shrinks.
    smallest_force: float = 0.1

    # Homogeneous start. How strongly the fit prefers the plainest material, in units of a misfit of 1 %: for the start,
    # and to see what no material of the basis can follow; and how often what clamps do to it is computed anew.
    strong_ridge: float = 0.3
    weak_ridge: float = 0.03
    bending_rounds: int = 3

    # Objective.
    #: Weight of the squared distance from the homogeneous fit, small: it decides only what data leave open.
    ridge: float = 0.02
    #: Relative jumps below this size are smoothed rather than counted.
    smallest_jump: float = 0.02
    #: The same in the end where displacements have noise, which would hide in gentle slopes that cost nothing. On the
    #: way so sharp a bend makes many local minima.
    sharp_jump: float = 0.005
    #: Length of the fibre vector from which it can grow: at zero it has no gradient.
    smallest_fibre: float = 0.01

    # Newton's method for the states: a relative residual far below what displacements are trusted to.
    newton_tolerance: float = 1e-6

    # Gauss-Newton steps.
    #: Iterations with total variation before jumps above the saturation size stop costing more.
    convex_iterations: int = 5
    #: Largest change of a parameter in one step: twice as stiff and more is beyond what a linearisation tells.
    largest_step: float = 1.0
    #: First step tried once jumps stop costing more: a step minimises a quadratic above the penalty, and falls short.
    over_relaxation: float = 1.7
    #: Factor between trials of a line search, and how many in the clipped and in the whole direction.
    fraction: float = 0.4
    clipped_trials: int = 2
    scaled_trials: int = 5
    #: Damping: where it begins, bounds, and factors after a whole step, a short one and none.
    first_damping: float = 1.0
    smallest_damping: float = 1e-4
    largest_damping: float = 1e6
    damping_after_success: float = 0.25
    damping_after_short_step: float = 4.0
    damping_after_failure: float = 100.0
    #: Fractions of a step from which it counts as whole, and below which as short.
    whole_step: float = 0.99
    short_step: float = 0.5

    # Linear solves.
    #: Conjugate-gradient iterations of a step, before and after jumps stop costing more.
    cg_iterations: tuple[int, int] = (150, 200)
    #: Residual at which they end, relative to the gradient: while the displacements are not explained, and then. On
    #: the way valleys are narrow: loose steps cross them to and fro, and where that ends is chance.
    cg_tolerance: tuple[float, float] = (0.001, 0.003)
    #: Share of the mean curvature of the data that joins the preconditioner, and how many random vectors estimate it.
    curvature_share: float = 0.3
    curvature_probes: int = 2
    #: Directions that a deflated solve keeps.
    deflated_directions: int = 40
    #: Relative residual and most iterations of a posterior sample.
    sample_tolerance: float = 0.01
    sample_iterations: int = 100
    #: Relative residual of the one that counts effective parameters, which are then missed by less than their chance.
    trace_tolerance: float = 0.03

    # Judging where a descent stands.
    #: A displacement misfit this close to its noise counts as explained.
    explained: float = 1.05
    #: Misfits of displacements and of forces, over their uncertainties, beyond which a test is not explained; and how
    #: far finite elements describe forces, over them: those of good fields are missed by a thousandth. Of sheets that
    #: are not of our making the terms follow no law to better than half a hundredth.
    unexplained: float = 2.0
    forces_unexplained: float = 2.5
    forces_described: float = 2.4e-3
    laws_described: float = 5e-3
    #: Standard deviations by which the misfit of displacements of known noise may exceed that noise by chance, and
    #: beyond which it never does.
    by_chance: float = 1.0
    never_by_chance: float = 3.0
    #: Standard deviations by which it never falls short of that noise. A field has parameters, so that by two it does.
    never_so_little: float = 5.0
    #: Share of the cost that misfits without noise have where the terms do not contain the material; else hundredths.
    much_left: float = 0.3
    #: Share of the cost below which misfits leave nothing to explain: of neo-Hookean sheets it is a few thousandths.
    nothing_left: float = 0.02

    #: Levenberg and Marquardt: shares of the curvature that are added until a step lowers the cost.
    damping_shares: tuple[float, ...] = (0.0, 0.01, 0.1, 1.0, 10.0)

    #: A grid of more cells begins from the field of every second of its lines: so many take a minute, and show where
    #: interfaces are. On finer grids a length of interface costs what it does here.
    most_cells_at_once: int = 3600

    #: Noise rules from this share of the assumed error of the description on; from all of it where nothing explains.
    noise_rules: float = 0.25

    #: What a jump of each further parameter counts, against one of the logarithm of the stiffness.
    jump_shares: dict[str, float] = field(
        default_factory=lambda: {"logit_dispersion": 0.3, "fibre_x": 4.0, "fibre_y": 4.0}
    )
    default_jump_share: float = 0.5

    def description_error(self, own_grid: bool, subcells: int, cells: int) -> float:
        """What finite elements miss of displacements, over the largest of them.

        Args:
            own_grid: whether the displacements were computed on the measured grid.
            subcells: rows and columns into which a cell is divided.
            cells: how many there are.
        """
        if own_grid:
            return self.same_grid_floor
        return (self.subcells_floor if subcells > 1 else self.cut_cells_floor) / cells**0.5

    def unit_length(self, areas) -> float:
        """Length of interface that counts as one, by the areas of the measured cells (cell,).

        On finer grids it costs what it does on the finest that is not begun from a coarser one.
        """
        return float((areas.sum() / min(len(areas), self.most_cells_at_once)) ** 0.5)


STRATEGY = Strategy()
