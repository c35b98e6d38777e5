// Colours, scales and the text of numbers.

/** Colours between which a field's are rounded; more than an eye tells apart. */
const SHADES = 128;
/** Share of the values at either end that may lie beyond the scale: single cells that are far off. */
const BEYOND = 0.01;

/** Colour at a share from 0 to 1 of a colour map, between the nearest of its samples. */
function colourAt(name, share) {
  const samples = DATA.colours[name];
  const place = Math.min(Math.max(share, 0), 1) * (samples.length - 1);
  const k = Math.min(Math.floor(place), samples.length - 2);
  const part = samples[k].map((value, m) => Math.round(value + (place - k) * (samples[k + 1][m] - value)));
  return `#${part.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

/** Scale of several rows of values that are drawn side by side. */
function scaleOf(map, rows) {
  if (map.colours === "phases") {
    const highest = Math.max(2, ...rows.map((row) => Math.max(...row)));
    return { low: 0.5, high: highest + 0.5, shades: highest, name: "viridis" };
  }
  const scale = { shades: SHADES, name: map.colours };
  if (map.unit === "°") return { ...scale, low: 0, high: 180 };
  const sorted = Float64Array.from(rows.flatMap((row) => [...row].filter(Number.isFinite))).sort();
  if (!sorted.length) return { ...scale, low: 0, high: 1 };
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  let [low, high] = [at(BEYOND), at(1 - BEYOND)];
  if (map.least !== null) [low, high] = [0, Math.max(map.least, high)];
  // Where all values are alike, they are in the middle.
  if (high - low <= 1e-6 * Math.abs(high)) [low, high] = [low - 0.5 * Math.abs(low), high + 0.5 * Math.abs(high)];
  if (high === low) high = low + 1;
  return { ...scale, low, high, below: sorted[0] < low, above: sorted.at(-1) > high };
}

/** Number of the shade of a value. */
function shadeOf(scale, value) {
  const shade = Math.floor((scale.shades * (value - scale.low)) / (scale.high - scale.low));
  return Math.min(Math.max(shade, 0), scale.shades - 1);
}

const shadeColour = (scale, shade) => colourAt(scale.name, scale.shades === 1 ? 0.5 : shade / (scale.shades - 1));

/** Round values between two, about so many. */
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((each) => each >= 0.75 * rough);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++)
    found.push(Number((k * step).toPrecision(12)));
  return found;
}

/** A number with so many digits. */
function shown(value, digits = 3) {
  if (!Number.isFinite(value)) return "-";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e6) return value.toExponential(digits - 1);
  return value.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size) + 1e-12)));
}

/** A round number without needless zeros. */
const round = (value) => (value !== 0 && Math.abs(value) < 1e-4 ? value.toExponential() : String(value));

const unitText = (unit) => (unit === "1" || unit === "" ? "-" : unit);
const withUnit = (value, unit) => (unit === "1" ? shown(value) : `${shown(value)} ${unit}`.replace(" °", "°"));

/** Text as it may stand in markup. */
const escaped = (text) => String(text).replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
