// How the stress-stretch curves are drawn.

/** Standard deviations from the curve to either side of its band. */
const BAND = 2;

/** Places on the drawing of a width, for axes from and to two values, with so many names below. */
function chartLayout(width, xs, ys, names) {
  const [left, top, right, below] = [58, 10, 16, 50 + 18 * names];
  const [w, h] = [width - left - right, Math.max(220, Math.min(340, 0.56 * width))];
  const x = (value) => left + (w * (value - xs[0])) / (xs[1] - xs[0]);
  const y = (value) => top + h - (h * (value - ys[0])) / (ys[1] - ys[0]);
  return {
    ...{ width, height: top + h + below, left, top, w, h, x, y, bottom: top + h, right: left + w },
    at: (u, v) => `${x(u).toFixed(1)},${y(v).toFixed(1)}`,
    back: (px) => xs[0] + ((px - left) / w) * (xs[1] - xs[0]),
  };
}

/** A line through those samples that are known. */
function lineMarkup(layout, { x, y, kind, thin }) {
  const parts = x.map((value, k) => {
    if (!Number.isFinite(y[k])) return "";
    return `${Number.isFinite(y[k - 1]) ? "L" : "M"}${layout.at(value, y[k])}`;
  });
  return `<path class="curve ${kind} ${thin ? "thin" : ""}" d="${parts.join("")}"/>`;
}

/** Edge of a band above (1) or below (-1) a curve. */
const edge = ({ y, spread }, sign) => y.map((value, k) => value + sign * BAND * (spread?.[k] ?? 0));

function bandMarkup(layout, series) {
  const known = [...series.x.keys()].filter((k) => Number.isFinite(series.y[k] + series.spread[k]));
  const side = (sign) => known.map((k) => layout.at(series.x[k], edge(series, sign)[k]));
  return `<path class="band ${series.kind}" d="M${[...side(1), ...side(-1).reverse()].join("L")}Z"/>`;
}

const MARKS = {
  truth: (at) => `<circle class="mark truth" r="3.6" transform="translate(${at})"/>`,
  third: (at) => `<rect class="mark third" x="-3.6" y="-3.6" width="7.2" height="7.2" transform="translate(${at})"/>`,
  fourth: (at) => `<path class="mark fourth" d="M0,-4.6l4.4,7.8h-8.8z" transform="translate(${at})"/>`,
};

/** One series by its look: marks, or a line with its band. */
function seriesMarkup(layout, series) {
  if (series.marks) {
    const shownMarks = [...series.x.keys()].filter((k) => k % series.every === 0 && Number.isFinite(series.y[k]));
    return shownMarks.map((k) => MARKS[series.kind](layout.at(series.x[k], series.y[k]))).join("");
  }
  return (series.spread ? bandMarkup(layout, series) : "") + lineMarkup(layout, series);
}

/** Names of the series, a line each, below the axis. */
function legendMarkup(layout, list) {
  const x = Math.max(8, Math.min(layout.left, layout.width - 420));
  return list.map(({ kind, marks, thin, spread, name }, k) => {
    const y = layout.bottom + 58 + 18 * k;
    const band = spread ? `<rect class="band ${kind}" x="${x}" y="${y - 9}" width="26" height="10"/>` : "";
    const line = `<path class="curve ${kind} ${thin ? "thin" : ""}" d="M${x},${y - 4}h26"/>`;
    const look = marks ? MARKS[kind](`${x + 13},${y - 4}`) : band + line;
    return `${look}<text x="${x + 33}" y="${y}">${escaped(name)}</text>`;
  });
}

/** Grid, numbers and names of both axes. */
function frameMarkup(layout, xs, ys, { xTitle, yTitle }) {
  const { left, top, bottom, right, w, h } = layout;
  const upright = ticks(...xs, Math.max(3, Math.min(7, w / 75))).map((value) => {
    const at = layout.x(value);
    return `<path class="grid" d="M${at},${top}V${bottom}"/>
      <text text-anchor="middle" x="${at}" y="${bottom + 17}">${round(value)}</text>`;
  });
  const level = ticks(...ys, 5).map((value) => {
    const at = layout.y(value);
    return `<path class="grid" d="M${left},${at}H${right}"/>
      <text text-anchor="end" x="${left - 6}" y="${at + 4}">${round(value)}</text>`;
  });
  return [
    ...upright,
    ...level,
    `<path class="axis" d="M${left},${top}V${bottom}H${right}"/>`,
    `<text text-anchor="middle" x="${left + w / 2}" y="${bottom + 35}">${escaped(xTitle)}</text>`,
    `<text text-anchor="middle" transform="translate(14,${top + h / 2})rotate(-90)">${escaped(yTitle)}</text>`,
  ];
}

/** How far the point was stretched in the test. */
function seenMarkup({ left, w, top, bottom }, at) {
  const [anchor, gap] = at > left + w / 2 ? ["end", -5] : ["start", 5];
  return `<path class="seen" d="M${at},${top}V${bottom}"/>
    <text class="soft" text-anchor="${anchor}" x="${at + gap}" y="${bottom - 7}">seen up to here</text>`;
}

/** The chart of some series: its markup and layout. */
function chartMarkup(width, view) {
  const { series, x0, seen, reading } = view;
  const finite = (sign) => series.flatMap((each) => edge(each, sign).filter(Number.isFinite));
  const [low, high] = [Math.min(0, ...finite(-1)), Math.max(1e-12, ...finite(1))];
  const xs = [x0, Math.max(...series.flatMap((each) => each.x))];
  const ys = [low, high + 0.04 * (high - low)];
  const layout = chartLayout(width, xs, ys, series.length);
  const markup = [
    ...frameMarkup(layout, xs, ys, view),
    seen > xs[0] && seen < xs[1] ? seenMarkup(layout, layout.x(seen)) : "",
    `<path class="reading" d="M${layout.x(reading)},${layout.top}V${layout.bottom}"/>`,
    ...series.map((each) => seriesMarkup(layout, each)),
    ...legendMarkup(layout, series),
  ];
  return { markup: markup.join(""), layout };
}
