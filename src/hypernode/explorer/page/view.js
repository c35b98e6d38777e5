// What is chosen, and the sheet that is drawn of it.

const $ = (id) => document.getElementById(id);
let runs = [];
const state = {
  map: "stiffness",
  step: 0,
  beside: "none",
  besideStep: 0,
  curtain: 0.5,
  deformed: false,
  cell: 0,
  mode: "uniaxial",
  direction: 0,
  reading: 0,
  curves: null,
};
/** What is drawn at present: layouts of both drawings, and the positions of the nodes of the sheet. */
const drawn = { sheet: null, chart: null, positions: null };

const rowOf = (rows, step) => rows[Math.min(step, rows.length - 1)];
const fieldOf = (run) => run.maps.get(state.map);

/** The fields on the two sides of the curtain, or one. */
function sides() {
  const [first, second] = runs;
  const field = fieldOf(first);
  const at = (run, step) => ({ run, step, values: rowOf(fieldOf(run).values, step), labels: run.shape });
  const main = { ...at(first, state.step), name: first.label };
  if (state.beside === "truth") {
    const labels = first.maps.get("phases").truth?.[0] ?? first.shape;
    const truth = { ...main, values: rowOf(field.truth, state.step), labels, name: "truth", isTruth: true };
    return [{ ...main, name: "identified" }, truth];
  }
  if (state.beside === "step") {
    return [state.step, state.besideStep].map((step) => ({ ...at(first, step), name: `step ${step + 1}` }));
  }
  if (state.beside === "run") {
    return [main, { ...at(second, Math.min(state.step, second.steps.length - 1)), name: second.label }];
  }
  return [main];
}

/** One scale for what is compared: all load steps, the truth, both strains, and the other run where it is shown. */
function sharedScale() {
  const kind = state.map.split("_")[0];
  const shownRuns = state.beside === "run" ? runs : [runs[0]];
  const maps = shownRuns.flatMap((run) => [...run.maps.values()]).filter((map) => map.key.split("_")[0] === kind);
  return scaleOf(
    fieldOf(runs[0]),
    maps.flatMap((map) => [...map.values, ...(map.truth ?? [])]),
  );
}

function drawSheet() {
  const svg = $("sheet");
  const field = fieldOf(runs[0]);
  const scale = sharedScale();
  const bounds = boundsOf(runs, state.deformed);
  const layout = sheetLayout(svg.clientWidth || 600, bounds);
  const shownSides = sides();
  drawn.sheet = layout;
  drawn.positions = positions(runs[0], state.deformed ? state.step : null);
  svg.setAttribute("viewBox", `0 0 ${layout.width} ${layout.height.toFixed(0)}`);
  svg.innerHTML = [
    '<defs><clipPath id="side-0"><rect/></clipPath><clipPath id="side-1"><rect/></clipPath></defs>',
    barMarkup(field.title, field.unit, scale, layout),
    axesMarkup(layout, bounds, runs[0].units.length),
    ...shownSides.map((side, k) => `<g clip-path="url(#side-${k})">${sideMarkup(side, scale, layout)}</g>`),
    '<path class="curtain casing"/><path class="curtain"/>',
    ...(shownSides.length > 1 ? shownSides.map((side, k) => sideName(side.name, k, layout)) : []),
    '<g id="pick"><circle class="pick" r="7"/><circle class="pick inner" r="7"/></g>',
  ].join("");
  drawCurtain();
  drawPick();
  $("about").textContent = field.about;
}

/** Cells, outline and fibres of one side. */
function sideMarkup(side, scale, layout) {
  const { run, values, labels } = side;
  const places = positions(run, state.deformed ? side.step : null);
  const angles = run.maps.get("angle")[side.isTruth ? "truth" : "values"][0];
  const fibres = state.map === "angle" || state.map === "anisotropy";
  return (
    cellsMarkup(run, values, scale, layout, places) +
    (state.map === "phases" ? "" : outlineMarkup(run, labels, layout, places)) +
    (fibres ? fibresMarkup(run, angles, layout, places) : "")
  );
}

/** The first name is above on the left, the second below on the right, so that long ones do not meet. */
function sideName(name, k, { x0, y0, w, h }) {
  const place = k === 0 ? `x="${x0 + 7}" y="${y0 + 17}"` : `x="${x0 + w - 7}" y="${y0 + h - 8}" text-anchor="end"`;
  return `<text class="halo" ${place}>${escaped(name)}</text>`;
}

function drawCurtain() {
  const { x0, y0, w, h } = drawn.sheet;
  const two = state.beside !== "none";
  // Cells are clipped a little outside of the frame, which their borders overlap.
  const at = two ? x0 + w * state.curtain : x0 + w + 2;
  [
    [x0 - 2, at],
    [at, Math.max(at, x0 + w + 2)],
  ].forEach(([from, to], k) => {
    const place = { x: from, y: y0 - 2, width: to - from, height: h + 4 };
    for (const [name, value] of Object.entries(place)) {
      document.querySelector(`#side-${k} rect`).setAttribute(name, value);
    }
  });
  for (const line of document.querySelectorAll(".curtain")) line.setAttribute("d", two ? `M${at},${y0}v${h}` : "");
}

function drawPick() {
  const [x, y] = drawn.positions.map((row) =>
    runs[0].cells.reduce((sum, corner) => sum + row[corner[state.cell]] / 4, 0),
  );
  $("pick").setAttribute("transform", `translate(${drawn.sheet.x(x)},${drawn.sheet.y(y)})`);
}
