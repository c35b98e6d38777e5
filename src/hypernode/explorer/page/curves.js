// The curves of the picked point: identified, true, of another run, and of sheets of one phase.

/** Marks of the truth stand at every so many samples. */
const TRUTH_EVERY = 4;

/** A material's curve at a cell. */
function curveOf(material, cell) {
  const p = material.params(cell);
  return { p, samples: curve(material.law, p, state.mode, state.direction, runs[0].largest) };
}

/** The identified curve of a run with the spread of its posterior samples, null where it has none. */
function identifiedCurve(run, cell) {
  const found = curveOf(run.identified, cell);
  const { law } = run.identified;
  const deviations = run.posterior && spread(run.posterior, cell, state.mode, found.samples, law, found.p);
  return { ...found, name: run.label, spread: deviations };
}

/** Everything at the picked point: the run's own curve, and `others` with their looks. */
function curvesAtPoint() {
  const [first, second] = runs;
  const others = [];
  if (first.truth) others.push({ ...curveOf(first.truth, state.cell), name: "truth", kind: "truth" });
  if (second) {
    const cell = nearestCell(second, second.nodes, first.centres[0][state.cell], first.centres[1][state.cell]);
    others.push({ ...identifiedCurve(second, cell), kind: "second" });
  }
  return { ...identifiedCurve(first, state.cell), others };
}

/** Sheets of one phase, where they were pulled as the curve is: measured, and computed with what was found. */
function sheetSeries() {
  if (state.mode !== "uniaxial") return [];
  const numbers = (list) => list.map((value) => value ?? NaN);
  return runs[0].sheets
    .filter((sheet) => state.direction % 180 === 90 * sheet.axis)
    .flatMap(({ phase, name, clamped, stretch, measured, computed }) => {
      const kind = phase === "matrix" ? "third" : "fourth";
      const test = `${phase} alone${clamped ? ", clamped" : ""}: ${name}`;
      return [
        { x: stretch, y: numbers(measured), kind, marks: true, every: 1, name: test },
        { x: stretch, y: numbers(computed), kind, thin: true, name: `the same sheet of the ${phase} found` },
      ].filter(({ y }) => y.some(Number.isFinite));
    });
}

/** All that the chart draws. */
function seriesAtPoint({ samples, spread, others }) {
  const x = samples.map((sample) => sample.extra + MODES[state.mode].origin);
  const y = (list) => list.map((sample) => sample.stress);
  return [
    { x, y: y(samples), spread, kind: "first", name: `${runs[0].label}, identified` },
    ...others.map((other) => {
      const marks = other.kind === "truth";
      return {
        x,
        y: y(other.samples),
        spread: other.spread,
        kind: other.kind,
        marks,
        every: TRUTH_EVERY,
        name: other.name,
      };
    }),
    ...sheetSeries(),
  ];
}

function drawChart() {
  const svg = $("chart");
  const mode = MODES[state.mode];
  state.curves = curvesAtPoint();
  const series = seriesAtPoint(state.curves);
  const { markup, layout } = chartMarkup(svg.clientWidth || 560, {
    series,
    x0: mode.origin,
    reading: series[0].x[state.reading],
    seen: mode.origin ? runs[0].seen[state.cell] : NaN,
    xTitle: mode.axis,
    yTitle: `nominal ${mode.component} along ${state.direction}° [${unitText(runs[0].units.stress)}]`,
  });
  drawn.chart = layout;
  svg.setAttribute("viewBox", `0 0 ${layout.width} ${layout.height.toFixed(0)}`);
  svg.innerHTML = markup;
  $("mode-about").textContent = aboutCurves(series);
  tellPicked();
  listNumbers();
}

/** Sentences on what the chart shows. */
function aboutCurves(series) {
  const said = [MODES[state.mode].about];
  if (series.some((each) => each.spread)) said.push("Bands are two standard deviations of the posterior samples.");
  if (series.some((each) => each.thin)) {
    said.push(
      "Sheets of one phase: force over section against mean stretch; clamps make a sheet stiffer than a point.",
    );
  }
  said.push("Beyond what a point was stretched in the test, its curve goes on by the law alone.");
  return said.join(" ");
}
