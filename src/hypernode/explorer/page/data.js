// Numbers out of text: the inverse of packing.py.

const DATA = JSON.parse(document.getElementById("data").textContent);

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Rows of numbers of an entry: all but the last axis of its shape are rows, in their order. */
function rowsOf(stream, entry) {
  const points = entry.shape.at(-1);
  const rows = entry.shape.slice(0, -1).reduce((product, size) => product * size, 1);
  const plane = rows * points;
  return Array.from({ length: rows }, (_, row) => {
    const levels = entry.levels?.[row];
    return Float64Array.from({ length: points }, (_, point) => {
      let code = 0;
      for (let k = 0; k < entry.bytes; k++) code += stream[entry.at + k * plane + row * points + point] * 256 ** k;
      if (levels) return levels[code];
      return code === entry.nan ? NaN : entry.low[row] + entry.step[row] * code;
    });
  });
}

/** A law with the parameters of every cell; posterior samples have their changes after those. */
function materialOf(stream, packed) {
  if (!packed) return null;
  const rows = packed.params.flatMap((entry) => rowsOf(stream, entry));
  const changes = packed.changes && rowsOf(stream, packed.changes);
  const samples = packed.changes ? packed.changes.shape[1] : 0;
  const at = (list, cell) => list.map((row) => row[row.length > 1 ? cell : 0]);
  return {
    law: LAWS[packed.law],
    samples,
    params: (cell) => at(rows, cell),
    sample: (cell, s) =>
      at(rows, cell).concat(
        at(
          rows.map((_, k) => changes[k * samples + s]),
          cell,
        ),
      ),
    unchanged: (cell) => at(rows, cell).concat(rows.map(() => 0)),
  };
}

/** A run with everything in it decoded. */
function runOf(stream, packed) {
  const nodes = rowsOf(stream, packed.nodes);
  const cells = rowsOf(stream, packed.cells).map((row) => Int32Array.from(row, Math.round));
  const count = cells[0].length;
  const mean = (axis) =>
    Float64Array.from({ length: count }, (_, k) =>
      cells.reduce((sum, corner) => sum + nodes[axis][corner[k]] / 4, 0),
    );
  return {
    ...packed,
    nodes,
    cells,
    count,
    displacement: rowsOf(stream, packed.displacement),
    centres: [mean(0), mean(1)],
    shape: rowsOf(stream, packed.shape)[0],
    seen: rowsOf(stream, packed.seen)[0],
    maps: new Map(
      packed.maps.map((map) => [
        map.key,
        {
          ...map,
          values: rowsOf(stream, map.values),
          truth: map.truth && rowsOf(stream, map.truth),
        },
      ]),
    ),
    identified: materialOf(stream, packed.identified),
    truth: materialOf(stream, packed.truth),
    posterior: materialOf(stream, packed.posterior),
  };
}
