// Where nodes and cells of a run are.

/** Positions of the nodes at a load step; at rest where it is null. */
function positions(run, step) {
  if (step === null) return run.nodes;
  return run.nodes.map((row, axis) => row.map((value, k) => value + run.displacement[2 * step + axis][k]));
}

/** Bounds of all positions that any step may show, so that axes stay where they are. */
function boundsOf(runs, deformed) {
  const bounds = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
  for (const run of runs) {
    for (const step of [null, ...(deformed ? run.steps.keys() : [])]) {
      const [x, y] = positions(run, step);
      for (let k = 0; k < x.length; k++) {
        bounds.x0 = Math.min(bounds.x0, x[k]);
        bounds.x1 = Math.max(bounds.x1, x[k]);
        bounds.y0 = Math.min(bounds.y0, y[k]);
        bounds.y1 = Math.max(bounds.y1, y[k]);
      }
    }
  }
  return bounds;
}

/** Number of the grid line of every value, and how many lines there are. */
function numbered(values) {
  const low = values.reduce((a, b) => Math.min(a, b));
  const size = values.reduce((a, b) => Math.max(a, b)) - low || 1;
  // Centres of one line differ by rounding.
  const places = Array.from(values, (value) => Math.round((1e6 * (value - low)) / size));
  const lines = [...new Set(places)].sort((a, b) => a - b);
  const number = new Map(lines.map((place, k) => [place, k]));
  return { numbers: places.map((place) => number.get(place)), count: lines.length };
}

/** Column and row of every cell, and the cell at each place; kept once it is known. */
function gridOf(run) {
  if (!run.grid) {
    const [column, row] = run.centres.map(numbered);
    const cell = new Map(column.numbers.map((number, k) => [`${number} ${row.numbers[k]}`, k]));
    run.grid = { column: column.numbers, row: row.numbers, columns: column.count, rows: row.count, cell };
  }
  return run.grid;
}

/** Cell whose centre is nearest to a position among given positions of the nodes. */
function nearestCell(run, [x, y], px, py) {
  let [best, distance] = [0, Infinity];
  for (let k = 0; k < run.count; k++) {
    let [dx, dy] = [-px, -py];
    for (const corner of run.cells) {
      dx += x[corner[k]] / 4;
      dy += y[corner[k]] / 4;
    }
    if (dx * dx + dy * dy < distance) [best, distance] = [k, dx * dx + dy * dy];
  }
  return best;
}
