// Paths as arrows from cell to cell: east to the right, south down.

const STEPS = { E: [1, 0], SE: [1, 1], S: [0, 1], SW: [-1, 1], W: [-1, 0], NW: [-1, -1], N: [0, -1], NE: [1, -1] };
const ACTIONS = ["E", "SE", "S", "SW", "W", "NW", "N", "NE"];

function cellsOf(moves) {
  const cells = [[0, 0]];
  for (const move of moves) {
    const [east, south] = cells[cells.length - 1];
    cells.push([east + STEPS[move][0], south + STEPS[move][1]]);
  }
  return cells;
}

// Moves, over those that were really made where these are known, in a square of `side` pixels.
function pathDrawn(moves, real, side) {
  const lines = [cellsOf(real), cellsOf(moves)];
  const all = lines.flat();
  const [west, north] = [0, 1].map((axis) => Math.min(...all.map((cell) => cell[axis])));
  const [east, south] = [0, 1].map((axis) => Math.max(...all.map((cell) => cell[axis])));
  const cells = Math.max(east - west, south - north, 4) + 2;
  const corner = [(west + east - cells) / 2, (north + south - cells) / 2];
  const words = `${moves.join(" ")}${real.length ? `; really ${real.join(" ")}` : ""}`;
  const svg = drawn("svg", { viewBox: `${corner[0]} ${corner[1]} ${cells} ${cells}`, width: side, height: side, class: "path", role: "img", "aria-label": words });
  if (real.length) {
    svg.append(drawn("path", { class: "real", d: strokes(lines[0]) }));
  }
  svg.append(drawn("path", { class: "copied", d: strokes(lines[1]) }));
  svg.append(drawn("circle", { class: "begin", cx: 0, cy: 0, r: 0.22 }));
  const [tip, before] = [lines[1][lines[1].length - 1], lines[1][lines[1].length - 2]];
  if (before) {
    svg.append(headDrawn(before, tip));
  }
  return svg;
}

function strokes(cells) {
  return cells.map(([east, south], place) => `${place ? "L" : "M"}${east} ${south}`).join("");
}

function headDrawn(from, to) {
  const turn = (Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI;
  return drawn("path", { class: "head", d: "M0.36 0L-0.24 -0.32L-0.24 0.32Z", transform: `translate(${to[0]} ${to[1]}) rotate(${turn})` });
}
