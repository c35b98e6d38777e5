// Picking, the controls, and the beginning.

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
/** Cells that an arrow key goes on with Shift. */
const FAR = 5;

const between = (value, low, high) => Math.min(Math.max(value, low), high);

function draw() {
  drawSheet();
  drawChart();
}

/** Takes a change over, and draws what it concerns. */
function change(part, redraw = draw) {
  Object.assign(state, part);
  showState();
  redraw();
}

function pick(cell) {
  if (cell === state.cell) return;
  change({ cell }, () => {
    drawPick();
    drawChart();
  });
}

/** Picks the cell at a place on the screen. */
function pickAt(event) {
  const box = $("sheet").getBoundingClientRect();
  const size = drawn.sheet.width / box.width;
  const [px, py] = [(event.clientX - box.left) * size, (event.clientY - box.top) * size];
  const { y0, h, back } = drawn.sheet;
  if (py < y0 || py > y0 + h) return;
  pick(nearestCell(runs[0], drawn.positions, ...back(px, py)));
}

/** The cell so many further on in a direction, across holes; the last one where the sheet ends before. */
function neighbour([dx, dy], far) {
  const grid = gridOf(runs[0]);
  let found = state.cell;
  let [column, row] = [grid.column[found], grid.row[found]];
  for (let steps = 0; steps < far; ) {
    [column, row] = [column + dx, row + dy];
    if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) break;
    const cell = grid.cell.get(`${column} ${row}`);
    if (cell === undefined) continue;
    found = cell;
    steps += 1;
  }
  return found;
}

/** Number of the sample of the curve below a place on the screen. */
function readingAt(event) {
  const box = $("chart").getBoundingClientRect();
  const at =
    drawn.chart.back(((event.clientX - box.left) * drawn.chart.width) / box.width) - MODES[state.mode].origin;
  return between(Math.round((at / (runs[0].largest - 1)) * (POINTS - 1)), 0, POINTS - 1);
}

/** What can stand beside a map: its truth, the other run where it knows the field, another load step. */
function besideChoices() {
  const field = fieldOf(runs[0]);
  const changes = runs[0].steps.length > 1 && (field.values.length > 1 || state.deformed);
  return [
    ["none", "nothing"],
    ...(field.truth ? [["truth", "the truth"]] : []),
    ...(runs[1]?.maps.has(state.map) ? [["run", runs[1].label]] : []),
    ...(changes ? [["step", "another load step"]] : []),
  ];
}

const optionMarkup = ([value, text]) => `<option value="${escaped(value)}">${escaped(text)}</option>`;

function showStep(id, step) {
  const { steps } = runs[0];
  const text = `${step + 1} of ${steps.length}: ${steps[step]}`;
  $(id).max = steps.length;
  $(id).value = step + 1;
  $(id).setAttribute("aria-valuetext", text);
  $(`${id}-text`).textContent = text;
}

/** Makes the controls say what the state is. */
function showState() {
  const choices = besideChoices();
  if (!choices.some(([value]) => value === state.beside)) state.beside = "none";
  $("map").value = state.map;
  $("deformed").checked = state.deformed;
  $("beside").innerHTML = choices.map(optionMarkup).join("");
  $("beside").value = state.beside;
  $("beside-step-label").hidden = state.beside !== "step";
  $("curtain-label").hidden = state.beside === "none";
  $("curtain-sides").textContent = sides()
    .map((side) => side.name)
    .join(" | ");
  $("step").disabled = fieldOf(runs[0]).values.length === 1 && !state.deformed;
  showStep("step", state.step);
  showStep("beside-step", state.besideStep);
  $("direction").value = state.direction;
  $("direction-text").textContent = `${state.direction}°`;
  $("along").disabled = !Number.isFinite(fibreAngle());
  $("reading").max = POINTS - 1;
  $("reading").value = state.reading;
  document.querySelector(`#modes input[value="${state.mode}"]`).checked = true;
}

/** Angle of the fibres at the picked point; NaN where it has none. */
const fibreAngle = () => runs[0].maps.get("angle").values[0][state.cell];

function listen() {
  const on = (id, kind, action) => $(id).addEventListener(kind, action);
  on("map", "change", () => change({ map: $("map").value }));
  on("beside", "change", () => change({ beside: $("beside").value }, drawSheet));
  on("step", "input", () => change({ step: $("step").value - 1 }));
  on("beside-step", "input", () => change({ besideStep: $("beside-step").value - 1 }, drawSheet));
  on("deformed", "change", () => change({ deformed: $("deformed").checked }, drawSheet));
  on("curtain", "input", () => change({ curtain: $("curtain").value / 100 }, drawCurtain));
  on("direction", "input", () => change({ direction: Number($("direction").value) }, drawChart));
  on("reading", "input", () => change({ reading: Number($("reading").value) }, drawChart));
  on("along", "click", () => change({ direction: Math.round(fibreAngle()) % 180 }, drawChart));
  on("modes", "change", (event) => change({ mode: event.target.value }, drawChart));
  on("save-png", "click", savePng);
  on("save-svg", "click", saveSvg);
  on("save-csv", "click", saveCsv);
  on("sheet", "click", pickAt);
  on("sheet", "pointermove", (event) => event.buttons && pickAt(event));
  on("chart", "pointermove", (event) => {
    const reading = readingAt(event);
    if (reading !== state.reading) change({ reading }, drawChart);
  });
  on("sheet", "keydown", (event) => {
    const step = { PageUp: 1, PageDown: -1 }[event.key];
    if (ARROWS[event.key]) pick(neighbour(ARROWS[event.key], event.shiftKey ? FAR : 1));
    else if (step) change({ step: between(state.step + step, 0, runs[0].steps.length - 1) });
    else return;
    event.preventDefault();
  });
  let width = innerWidth;
  addEventListener("resize", () => {
    // A phone that hides its address bar changes only the height.
    if (innerWidth !== width) draw();
    width = innerWidth;
  });
}

async function begin() {
  const stream = await inflated($("arrays").textContent.trim());
  runs = DATA.runs.map((run) => runOf(stream, run));
  const [first] = runs;
  const names = runs.map((run) => run.name.split("/"));
  // Methods of one case are called by their own names.
  const oneCase = names.length > 1 && names.every(([name]) => name === names[0][0]);
  runs.forEach((run, k) => (run.label = oneCase ? names[k][1] : run.name));
  $("map").innerHTML = [...first.maps.values()].map(({ key, title }) => optionMarkup([key, title])).join("");
  const radio = ([key, { title }]) => `<label><input type="radio" name="mode" value="${key}"> ${title}</label>`;
  $("modes").insertAdjacentHTML("beforeend", Object.entries(MODES).map(radio).join(""));
  const reading = Math.round(((first.shape_stretch - 1) / (first.largest - 1)) * (POINTS - 1));
  Object.assign(state, first.start, { step: first.steps.length - 1, reading: between(reading, 1, POINTS - 1) });
  writeNotes();
  showState();
  listen();
  draw();
  // For scripts: what is chosen and drawn, and the curve as text.
  window.explorer = { state, change, pick, csv: curveAsCsv, run: (k) => runs[k] };
}

begin();
