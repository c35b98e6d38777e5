// What is seen as a picture, and the curve as a table.

/** Pixels of a picture for each of the page. */
const SHARPNESS = 3;
/** Colours of a picture, which may be printed: those of the page in light. */
const LIGHT = {
  ink: "#1b1f24",
  soft: "#5b6470",
  line: "#d4d9df",
  blank: "#e9ecef",
  panel: "#ffffff",
  halo: "#ffffff",
  first: "#0072b2",
  second: "#d55e00",
  third: "#009e73",
  fourth: "#a6568a",
  fail: "#c00000",
  warn: "#b86e00",
};

function saved(name, content, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const fileName = () => `${runs[0].name.replace("/", "_")}_${state.map}`;

/** What a drawing of the page holds, and its size. */
function contentOf(id) {
  const svg = document.getElementById(id);
  const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
  const content = [...svg.childNodes].map((node) => new XMLSerializer().serializeToString(node)).join("");
  return { width, height, content };
}

/** Sheet and chart side by side as one drawing in light colours that stands alone. */
function viewAsSvg() {
  const style = document.getElementById("drawing").textContent.replace(/var\(--(\w+)\)/g, (_, name) => LIGHT[name]);
  const [sheet, chart] = ["sheet", "chart"].map(contentOf);
  const words = headline();
  const [gap, head, foot] = [24, words.verdict ? 52 : 34, 22];
  const width = sheet.width + gap + chart.width;
  const height = head + Math.max(sheet.height, chart.height) + foot;
  const lines = [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}">`,
    `<style>${style}</style><rect width="100%" height="100%" fill="#ffffff"/>`,
    `<text class="strong" x="8" y="20">${escaped(words.title)}</text>`,
    `<text class="strong ${words.level}" x="8" y="38">${escaped(words.verdict)}</text>`,
    `<g transform="translate(0,${head})">${sheet.content}</g>`,
    `<g transform="translate(${sheet.width + gap},${head})">${chart.content}</g>`,
    `<text class="soft" x="8" y="${height - 8}">${escaped(`${words.point}. ${words.mode}`)}</text></svg>`,
  ];
  return { width, height, text: lines.join("\n") };
}

function saveSvg() {
  saved(`${fileName()}.svg`, viewAsSvg().text, "image/svg+xml");
}

function savePng() {
  const { width, height, text } = viewAsSvg();
  const image = new Image();
  image.onload = () => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [SHARPNESS * width, SHARPNESS * height];
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => saved(`${fileName()}.png`, blob, "image/png"));
  };
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
}

/** Columns of the curve by their heads: what is shown, then deformation and stress by components. */
function curveColumns() {
  const { samples, spread: deviations, others } = state.curves;
  const mode = MODES[state.mode];
  const unit = unitText(runs[0].units.stress);
  const columns = [
    [mode.axis, samples.map((sample) => sample.extra + mode.origin)],
    [`stress ${runs[0].label} [${unit}]`, samples.map((sample) => sample.stress)],
    [`standard deviation [${unit}]`, deviations ?? samples.map(() => NaN)],
    ...others.map((other) => [`stress ${other.name} [${unit}]`, other.samples.map((sample) => sample.stress)]),
  ];
  for (const [name, of] of [
    ["F", "-"],
    ["P", unit],
  ]) {
    ["xX", "xY", "yX", "yY"].forEach((part, k) => {
      columns.push([`${name}_${part} [${of}]`, samples.map((sample) => sample[name]?.[k] ?? NaN)]);
    });
  }
  return columns;
}

function curveAsCsv() {
  const columns = curveColumns();
  const words = headline();
  const number = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(9))) : "");
  const rows = columns[0][1].map((_, k) => columns.map(([, values]) => number(values[k])).join(","));
  const remarks = [words.title, words.verdict, `${words.point}. ${words.mode}`].filter(Boolean);
  return [...remarks.map((text) => `# ${text}`), columns.map(([head]) => head).join(","), ...rows, ""].join("\n");
}

function saveCsv() {
  saved(`${fileName()}_${state.mode}.csv`, curveAsCsv(), "text/csv");
}
