// What is picked in words and numbers, and the tables.

/** Words on what is shown, for the live text and for what is saved. */
function headline() {
  const [run] = runs;
  const [x, y] = run.centres.map((row) => withUnit(row[state.cell], run.units.length));
  const field = fieldOf(run);
  const told = (rows) => {
    const value = rowOf(rows, state.step)[state.cell];
    return field.colours === "phases" ? String(value) : withUnit(value, field.unit);
  };
  const truth = field.truth ? ` (truth ${told(field.truth)})` : "";
  const { level, criteria } = run.verdict;
  return {
    title: runs.map((each) => each.name).join(" beside "),
    level,
    verdict: level === "pass" ? "" : `${level.toUpperCase()}: ${criteria[0].sentence}`,
    point: `x ${x}, y ${y}`,
    field: `${field.title} ${told(field.values)}${truth}`,
    mode: `${MODES[state.mode].title} along ${state.direction}°`,
  };
}

/** The point and its values, for eyes and screen readers. */
function tellPicked() {
  const words = headline();
  const mode = MODES[state.mode];
  const unit = runs[0].units.stress;
  const { samples, spread: deviations, others } = state.curves;
  const { extra, stress } = samples[state.reading];
  const at = shown(extra + mode.origin, 4);
  const found = Number.isFinite(stress)
    ? withUnit(stress, unit)
    : "not found: the law has no state with free sides there";
  const band = Number.isFinite(deviations?.[state.reading]) ? ` ± ${shown(2 * deviations[state.reading])}` : "";
  const compared = others.map((other) => `${other.name} ${withUnit(other.samples[state.reading].stress, unit)}`);
  $("reading-text").textContent = at;
  $("picked").textContent =
    `${words.point}. ${words.field}. ${words.mode}, ${mode.variable} ${at}: ` +
    `${[`stress ${found}${band}`, ...compared].join("; ")}.`;
}

/** A table; a cell is text, a number as text, or the level of a verdict. */
function tableMarkup(heads, rows, caption = "") {
  const cell = (value) => {
    if (value.level) return `<td class="level" data-level="${escaped(value.level)}">${escaped(value.level)}</td>`;
    const isNumber = /^[-+]?[\d.]+(e[-+]?\d+)?$/.test(value);
    return `<td${isNumber ? ' class="number"' : ""}>${escaped(value)}</td>`;
  };
  const head = heads.map((text) => `<th scope="col">${escaped(text)}</th>`).join("");
  return [
    caption && `<caption>${escaped(caption)}</caption>`,
    head && `<thead><tr>${head}</tr></thead>`,
    "<tbody>",
    ...rows.map((row) => `<tr>${row.map(cell).join("")}</tr>`),
    "</tbody>",
  ].join("");
}

const table = (...content) => `<div class="scroll"><table>${tableMarkup(...content)}</table></div>`;

/** Every fifth sample of the curve. */
function listNumbers() {
  const { samples, spread: deviations, others } = state.curves;
  const mode = MODES[state.mode];
  const heads = [mode.axis, `${runs[0].label} [${unitText(runs[0].units.stress)}]`];
  const columns = [
    samples.map((sample) => shown(sample.extra + mode.origin, 4)),
    samples.map(({ stress }) => shown(stress)),
  ];
  if (deviations) {
    heads.push("standard deviation");
    columns.push(deviations.map((value) => shown(value)));
  }
  for (const other of others) {
    heads.push(other.name);
    columns.push(other.samples.map(({ stress }) => shown(stress)));
  }
  const rows = samples.map((_, k) => columns.map((column) => column[k])).filter((_, k) => k % 5 === 0);
  $("numbers").innerHTML = tableMarkup(heads, rows);
}

/** The verdict on a run in a line: the level, then what is not met, the worst first. */
function verdictMarkup({ label, verdict: { level, criteria } }) {
  const unmet = criteria.filter((each) => each.level === "fail" || each.level === "warn");
  const said = unmet.length ? unmet.map((each) => each.sentence).join(" ") : "Every criterion that is judged is met.";
  const name = runs.length > 1 ? `${label}: ` : "";
  const word = `<strong>${escaped(level)}</strong>`;
  return `<p class="verdict" data-level="${escaped(level)}">${word} ${escaped(name + said)}</p>`;
}

/** Verdicts, forces and scores, which do not change. */
function writeNotes() {
  const everyRun = (markup) => runs.map((run) => markup(run, runs.length > 1 ? run.label : "")).join("");
  $("verdicts").innerHTML = everyRun(verdictMarkup);
  $("criteria").innerHTML = everyRun(({ verdict: { criteria, suspects } }, caption) => {
    const rows = criteria.map(({ level, name, sentence }) => [{ level }, name, sentence]);
    const causes = suspects.map(({ name, sentence }) => [name, sentence]);
    const likeliest = causes.length ? table(["suspect", "what speaks for it"], causes, caption) : "";
    return table(["level", "criterion", "why"], rows, caption) + likeliest;
  });
  $("doubt").innerHTML = everyRun(({ doubt }, caption) => {
    if (!doubt.length) return "<p>Not known: there are no samples.</p>";
    const parts = ["samples [%]", "other laws [%]", "forces missed [times]", "networks [%]", "level [%]", "all [%]"];
    const heads = ["mode", "stretch", "seen", ...parts];
    const shares = ({ spread, other_laws: laws, missed, networks, level, total }) =>
      [100 * spread, 100 * laws, missed, 100 * networks, 100 * level, 100 * total].map((share) => shown(share, 2));
    const rows = doubt.map((each) => [
      each.mode.replace("_", " "),
      shown(each.stretch, 3),
      each.inside ? "yes" : "beyond",
      ...shares(each),
    ]);
    return table(heads, rows, caption);
  });
  $("budget").innerHTML = everyRun(({ budget }, caption) => {
    if (!budget.length) return "<p>No force was recorded: the level is a convention.</p>";
    const heads = ["input", "type", "prior [%]", "posterior [%]", "of the level [%]", "told by"];
    const share = (value) => (value === null ? "" : shown(100 * value, 2));
    const rows = budget.map((each) => [
      each.input,
      each.type,
      share(each.prior),
      share(each.posterior),
      share(each.level),
      each.told_by,
    ]);
    return table(heads, rows, caption);
  });
  $("forces").innerHTML = everyRun(({ label, forces, steps, units }, caption) => {
    if (!forces.length) return `<p>${escaped(label)}: no force is known.</p>`;
    const heads = ["step", "force", `measured [${unitText(units.force)}]`, "identified", "missed by [%]"];
    const rows = forces.map(({ step, name, measured, identified, error }) => [
      steps[step],
      name,
      shown(measured),
      shown(identified),
      shown(error, 2),
    ]);
    return table(heads, rows, caption);
  });
  $("trace").innerHTML = everyRun(({ trace }, caption) =>
    trace ? table(trace.heads, trace.rows, caption) : "<p>This method keeps no record of candidates.</p>",
  );
  $("facts").innerHTML = everyRun(({ facts }, caption) => table([], facts, caption));
}
