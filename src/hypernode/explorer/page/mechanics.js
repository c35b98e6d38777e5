// Stress-stretch curves of one point: what it undergoes in each mode. The laws themselves are the material's own.

const where = (condition, yes, no) => (condition ? yes : no);
/** Curves have so many points; enough that straight lines between them look smooth. */
const POINTS = 41;
/** A step of the sides' motion below this is rounding; a difference that is tiny beside a stretch of one. */
const CONVERGED = 1e-10,
  ITERATIONS = 25,
  DIFFERENCE = 1e-6;

const MODES = {
  equibiaxial: {
    title: "Equibiaxial",
    axis: "stretch [-]",
    variable: "stretch",
    component: "stress",
    origin: 1,
    free: false,
    about: "Stretched alike in all directions; shown is the normal stress along the direction.",
    F: (extra, a, b) => combined(1 + extra, 0, 1 + extra, a, b),
    stress: (P, a, b) => along(P, a, a),
  },
  uniaxial: {
    title: "Uniaxial",
    axis: "stretch [-]",
    variable: "stretch",
    component: "stress",
    origin: 1,
    free: true,
    about:
      "Pulled along the direction; the sides are free of traction, so that the sheet contracts and shears as it likes.",
    F: (extra, a, b, [shear, width]) => combined(1 + extra, shear, width, a, b),
    stress: (P, a, b) => along(P, a, a),
  },
  shear: {
    title: "Shear",
    axis: "amount of shear [-]",
    variable: "shear",
    component: "shear stress",
    origin: 0,
    free: false,
    about: "Simple shear: lines along the direction slide over one another; shown is the shear stress.",
    F: (extra, a, b) => combined(1, extra, 1, a, b),
    stress: (P, a, b) => along(P, a, b),
  },
};

/** F that takes a to `stretch` a and b to `shear` a + `width` b, by rows. */
function combined(stretch, shear, width, a, b) {
  const F = [];
  for (const i of [0, 1])
    for (const j of [0, 1]) {
      F.push(stretch * a[i] * a[j] + (shear * a[i] + width * b[i]) * b[j]);
    }
  return F;
}

/** Component u . P w. */
const along = (P, u, w) => u[0] * (P[0] * w[0] + P[1] * w[1]) + u[1] * (P[2] * w[0] + P[3] * w[1]);

/** How P.a and both tractions of the sides change with the sides' shear and width, by differences. */
function slopes(law, p, mode, extra, a, b, sides, P) {
  const columns = [0, 1].map((k) => {
    const moved = sides.map((value, m) => value + (m === k ? DIFFERENCE : 0));
    const Q = law(mode.F(extra, a, b, moved), p);
    return [along(Q, a, a), along(Q, a, b), along(Q, b, b)].map(
      (value, i) => (value - [along(P, a, a), along(P, a, b), along(P, b, b)][i]) / DIFFERENCE,
    );
  });
  return [0, 1, 2].map((row) => columns.map((column) => column[row]));
}

/** Solves the two equations of two unknowns. */
function solved([[m00, m01], [m10, m11]], [r0, r1]) {
  const determinant = m00 * m11 - m01 * m10;
  return [(m11 * r0 - m01 * r1) / determinant, (m00 * r1 - m10 * r0) / determinant];
}

/** [shear, width] of free sides by Newton's method, or null where none is found. */
function freeSides(law, p, mode, extra, a, b, start) {
  let sides = start;
  for (let k = 0; k < ITERATIONS; k++) {
    const P = law(mode.F(extra, a, b, sides), p);
    const [, ...rows] = slopes(law, p, mode, extra, a, b, sides, P);
    const step = solved(rows, [along(P, a, b), along(P, b, b)]);
    sides = sides.map((value, m) => value - step[m]);
    if (!(sides[1] > 0.05) || !Number.isFinite(sides[0])) return null;
    if (Math.hypot(...step) < CONVERGED) return sides;
  }
  return null;
}

/** Samples of a curve: what is stretched by `extra`, F, P, the stress that is shown, and the sides. */
function curve(law, p, name, degrees, largest) {
  const mode = MODES[name],
    angle = (degrees * Math.PI) / 180;
  const a = [Math.cos(angle), Math.sin(angle)],
    b = [-a[1], a[0]];
  let sides = [0, 1],
    before = sides;
  return Array.from({ length: POINTS }, (_, k) => {
    const extra = ((largest - 1) * k) / (POINTS - 1);
    if (mode.free && sides) {
      const guess = sides.map((value, m) => 2 * value - before[m]);
      [before, sides] = [sides, freeSides(law, p, mode, extra, a, b, guess)];
    }
    if (!sides) return { extra, stress: NaN, a, b };
    const F = mode.F(extra, a, b, sides),
      P = law(F, p);
    return { extra, F, P, a, b, sides, stress: mode.stress(P, a, b) };
  });
}

/** Standard deviation of the stress over posterior samples, along a curve of the best field, to first order. */
function spread(posterior, cell, name, samples, law, p) {
  const mode = MODES[name],
    best = posterior.unchanged(cell);
  const drawn = Array.from({ length: posterior.samples }, (_, s) => posterior.sample(cell, s));
  return samples.map(({ extra, F, P, a, b, sides }) => {
    if (!F) return NaN;
    const reference = posterior.law(F, best);
    // The free sides of every sample move until they carry nothing again.
    const [pull, ...rows] = mode.free ? slopes(law, p, mode, extra, a, b, sides, P) : [];
    const changes = drawn.map((params) => {
      const change = posterior.law(F, params).map((value, k) => value - reference[k]);
      const there = mode.stress(change, a, b);
      if (!mode.free) return there;
      const moved = solved(rows, [along(change, a, b), along(change, b, b)]);
      return there - pull[0] * moved[0] - pull[1] * moved[1];
    });
    const mean = changes.reduce((sum, value) => sum + value, 0) / changes.length;
    return Math.sqrt(changes.reduce((sum, value) => sum + (value - mean) ** 2, 0) / (changes.length - 1));
  });
}
