// How the sheet is drawn: cells in the colours of a field, outlines, fibres, the bar of the colours and the axes.

/** Most cells along a side that get a mark of their fibres, and the share of a cell's place that half a mark takes. */
const FIBRE_MARKS = 22;
const HALF_MARK = 0.42;

/** Places on the drawing of a width: the frame of the sheet and the functions from positions. */
function sheetLayout(width, { x0, x1, y0, y1 }) {
  const [left, top, right, below] = [46, 56, 14, 40];
  const tallest = Math.max(300, Math.min(620, 0.9 * width));
  const scale = Math.min((width - left - right) / (x1 - x0), tallest / (y1 - y0));
  const [w, h] = [scale * (x1 - x0), scale * (y1 - y0)];
  const from = left + Math.max(0, (width - left - right - w) / 2);
  const x = (value) => from + scale * (value - x0);
  const y = (value) => top + h - scale * (value - y0);
  return {
    ...{ width, height: top + h + below, x0: from, y0: top, w, h, x, y },
    at: (u, v) => `${x(u).toFixed(1)},${y(v).toFixed(1)}`,
    back: (px, py) => [x0 + (px - from) / scale, y0 + (top + h - py) / scale],
  };
}

/** The cells of a run, one path for every shade. */
function cellsMarkup(run, values, scale, layout, [x, y]) {
  const paths = new Map();
  for (let k = 0; k < run.count; k++) {
    const shade = Number.isFinite(values[k]) ? shadeOf(scale, values[k]) : -1;
    const corners = run.cells.map((corner) => layout.at(x[corner[k]], y[corner[k]]));
    paths.set(shade, `${paths.get(shade) ?? ""}M${corners.join("L")}Z`);
  }
  const markup = [...paths].map(([shade, d]) => {
    if (shade < 0) return `<path class="blank" d="${d}"/>`;
    const colour = shadeColour(scale, shade);
    return `<path fill="${colour}" stroke="${colour}" stroke-width=".6" d="${d}"/>`;
  });
  return markup.join("");
}

/** Sides between cells of different labels, such as those of the inclusion and others. */
function outlineMarkup(run, labels, layout, [x, y]) {
  const owner = new Map();
  const parts = [];
  for (let k = 0; k < run.count; k++) {
    for (let m = 0; m < 4; m++) {
      const ends = [run.cells[m][k], run.cells[(m + 1) % 4][k]];
      const key = `${Math.min(...ends)} ${Math.max(...ends)}`;
      if (owner.has(key) && labels[owner.get(key)] !== labels[k]) {
        parts.push(`M${ends.map((node) => layout.at(x[node], y[node])).join("L")}`);
      }
      owner.set(key, k);
    }
  }
  const d = parts.join("");
  return d && `<path class="outline shadow" d="${d}"/><path class="outline" d="${d}"/>`;
}

/** Mark of the fibres of a cell: their direction at rest, carried along by the cell's deformation. */
function fibreMark(run, k, angle, length, layout, [x, y]) {
  const corners = run.cells.map((corner) => [layout.x(x[corner[k]]), layout.y(y[corner[k]])]);
  const [p0, p1, p2, p3] = corners;
  const [low, high] = [run.cells[0][k], run.cells[2][k]];
  const [u, v] = [Math.cos(angle), Math.sin(angle)].map((part, axis) => {
    const size = run.nodes[axis][high] - run.nodes[axis][low];
    return part / size;
  });
  const along = [0, 1].map((i) => u * (p1[i] + p2[i] - p0[i] - p3[i]) + v * (p3[i] + p2[i] - p0[i] - p1[i]));
  const centre = [0, 1].map((i) => corners.reduce((sum, corner) => sum + corner[i] / 4, 0));
  const half = (length * Math.hypot(p1[0] - p0[0], p1[1] - p0[1])) / (Math.hypot(...along) || 1);
  const ends = [-1, 1].map((sign) => centre.map((value, i) => (value + sign * half * along[i]).toFixed(1)));
  return `M${ends.join("L")}`;
}

function fibresMarkup(run, angles, layout, places) {
  const every = Math.max(1, Math.round(Math.sqrt(run.count) / FIBRE_MARKS));
  const grid = gridOf(run);
  const parts = [];
  for (let k = 0; k < run.count; k++) {
    if (grid.column[k] % every || grid.row[k] % every || !Number.isFinite(angles[k])) continue;
    parts.push(fibreMark(run, k, (angles[k] * Math.PI) / 180, HALF_MARK * every, layout, places));
  }
  const d = parts.join("");
  return d && `<path class="shadow" d="${d}"/><path class="fibres" d="${d}"/>`;
}

/** Numbers that stand at the bar of the colours. */
function barTicks(unit, scale, width) {
  if (scale.shades < SHADES) return Array.from({ length: scale.shades }, (_, k) => k + 1);
  if (unit === "°") return [0, 45, 90, 135, 180];
  return ticks(scale.low, scale.high, Math.max(2, Math.min(6, width / 70)));
}

/** The bar of the colours with its numbers, above the sheet; its ends are pointed where values lie beyond. */
function barMarkup(title, unit, scale, { x0, w }) {
  const [y, h] = [20, 11];
  const name = `<text class="strong" x="${x0}" y="13">${escaped(title)} [${escaped(unitText(unit))}]</text>`;
  const blocks = Array.from({ length: scale.shades }, (_, k) => {
    const place = `x="${(x0 + (k * w) / scale.shades).toFixed(2)}" width="${(w / scale.shades + 0.5).toFixed(2)}"`;
    return `<rect fill="${shadeColour(scale, k)}" ${place} y="${y}" height="${h}"/>`;
  });
  const end = (at, sign, shade) =>
    `<path fill="${shadeColour(scale, shade)}" d="M${at},${y}l${7 * sign},${h / 2}L${at},${y + h}Z"/>`;
  const numbers = barTicks(unit, scale, w).map((value) => {
    const at = x0 + (w * (value - scale.low)) / (scale.high - scale.low);
    return `<path class="axis" d="M${at},${y + h}v3"/>
      <text text-anchor="middle" x="${at}" y="${y + h + 15}">${round(value)}</text>`;
  });
  const ends = [scale.below ? end(x0, -1, 0) : "", scale.above ? end(x0 + w, 1, scale.shades - 1) : ""];
  return [name, ...blocks, ...ends, ...numbers].join("");
}

/** Frame, numbers and names of the axes. */
function axesMarkup(layout, bounds, length) {
  const { x0, y0, w, h } = layout;
  const unit = escaped(unitText(length));
  const below = ticks(bounds.x0, bounds.x1, Math.max(2, Math.min(6, w / 70))).map((value) => {
    const at = layout.x(value);
    return `<path class="axis" d="M${at},${y0 + h}v4"/>
      <text text-anchor="middle" x="${at}" y="${y0 + h + 17}">${round(value)}</text>`;
  });
  const beside = ticks(bounds.y0, bounds.y1, Math.max(2, Math.min(6, h / 60))).map((value) => {
    const at = layout.y(value);
    return `<path class="axis" d="M${x0},${at}h-4"/>
      <text text-anchor="end" x="${x0 - 7}" y="${at + 4}">${round(value)}</text>`;
  });
  return [
    `<rect class="axis" x="${x0}" y="${y0}" width="${w}" height="${h}"/>`,
    ...below,
    ...beside,
    `<text text-anchor="middle" x="${x0 + w / 2}" y="${y0 + h + 33}">x [${unit}]</text>`,
    `<text text-anchor="middle" transform="translate(${x0 - 34},${y0 + h / 2})rotate(-90)">y [${unit}]</text>`,
  ].join("");
}
