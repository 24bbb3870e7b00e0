// A chart of lengths against moves: lines, bands, and what they are at the place that is pointed at.

const CHART = { width: 880, height: 380, left: 56, right: 16, top: 14, bottom: 44 };

function chartAxes(size, endMove, endLength) {
  const across = (move) => size.left + (move / endMove) * (size.width - size.left - size.right);
  const up = (length) => size.height - size.bottom - (length / endLength) * (size.height - size.top - size.bottom);
  return { across, up, size, endMove, endLength };
}

function axesDrawn(axes, names) {
  const { size, across, up } = axes;
  const group = drawn("g", { class: "axes" });
  for (const length of ticks(axes.endLength, 5)) {
    group.append(drawn("line", { x1: size.left, x2: size.width - size.right, y1: up(length), y2: up(length) }));
    group.append(drawn("text", { x: size.left - 8, y: up(length) + 4, "text-anchor": "end" }, counted(length)));
  }
  for (const move of ticks(axes.endMove, 8)) {
    group.append(drawn("text", { x: across(move), y: size.height - size.bottom + 18, "text-anchor": "middle" }, counted(move)));
  }
  group.append(drawn("text", { x: (size.left + size.width - size.right) / 2, y: size.height - 6, "text-anchor": "middle", class: "name" }, names[0]));
  const middle = (size.top + size.height - size.bottom) / 2;
  group.append(drawn("text", { x: 14, y: middle, "text-anchor": "middle", class: "name", transform: `rotate(-90 14 ${middle})` }, names[1]));
  return group;
}

function line(axes, moves, lengths) {
  return moves.map((move, place) => `${place ? "L" : "M"}${axes.across(move).toFixed(1)} ${axes.up(lengths[place]).toFixed(1)}`).join("");
}

function band(axes, curve) {
  const back = [...curve.moves].reverse();
  const low = line(axes, back, [...curve.low].reverse()).replace("M", "L");
  return `${line(axes, curve.moves, curve.high)}${low}Z`;
}

function curvesChart(data) {
  const endMove = Math.max(...data.curves.map((curve) => curve.moves[curve.moves.length - 1]));
  const longest = Math.max(data.cap, ...data.curves.map((curve) => Math.max(...curve.mean)));
  const axes = chartAxes(CHART, endMove, longest * 1.04);
  const svg = drawn("svg", { viewBox: `0 0 ${CHART.width} ${CHART.height}`, class: "chart", role: "img", "aria-label": "Best path length against moves" });
  svg.append(axesDrawn(axes, ["moves made by the learner", "best path length (moves)"]));
  svg.append(drawn("line", { class: "cap", x1: CHART.left, x2: CHART.width - CHART.right, y1: axes.up(data.cap), y2: axes.up(data.cap) }));
  for (const curve of data.curves) {
    svg.append(curveDrawn(axes, curve));
  }
  return pointedAt(svg, axes, data);
}

function curveDrawn(axes, curve) {
  const group = drawn("g", { stroke: curve.colour, fill: "none" });
  if (curve.low) {
    group.append(drawn("path", { d: band(axes, curve), fill: curve.colour, "fill-opacity": 0.18, stroke: "none" }));
  } else if (curve.count > 1) {
    for (const trial of curve.trials) {
      group.append(drawn("path", { d: line(axes, curve.moves, trial.lengths), "stroke-width": 0.7, "stroke-opacity": 0.5 }));
    }
  }
  group.append(drawn("path", { d: line(axes, curve.moves, curve.mean), "stroke-width": 1.8, "stroke-linejoin": "round" }));
  return group;
}

// A rule under the pointer, and beside the legend's names what the curves are there.
function pointedAt(svg, axes, data) {
  const rule = drawn("line", { class: "rule", y1: CHART.top, y2: CHART.height - CHART.bottom, visibility: "hidden" });
  svg.append(rule);
  const legend = element("ul", { class: "legend" });
  const readings = data.curves.map((curve) => {
    const button = element("button", { type: "button", class: "number" }, "");
    const name = ` ${curve.name} (${curve.count} ${curve.count === 1 ? "trial" : "trials"}) `;
    legend.append(element("li", {}, element("span", { class: "swatch", style: `background:${curve.colour}` }), name, button));
    return { curve, button };
  });
  const read = (move) => {
    for (const { curve, button } of readings) {
      readAt(curve, move, button, data);
    }
  };
  read(axes.endMove);
  svg.addEventListener("pointermove", (event) => {
    const box = svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * CHART.width;
    const move = Math.min(axes.endMove, Math.max(0, ((x - CHART.left) / (CHART.width - CHART.left - CHART.right)) * axes.endMove));
    rule.setAttribute("x1", axes.across(move));
    rule.setAttribute("x2", axes.across(move));
    rule.setAttribute("visibility", "visible");
    read(move);
  });
  return element("figure", {}, legend, svg);
}

function readAt(curve, move, button, data) {
  let place = curve.moves.findIndex((known) => known > move);
  place = place < 0 ? curve.moves.length - 1 : Math.max(0, place - 1);
  const interval = curve.low ? ` (${curve.low[place].toFixed(1)} to ${curve.high[place].toFixed(1)})` : "";
  button.textContent = `${curve.mean[place].toFixed(1)}${interval} at move ${counted(curve.moves[place])}`;
  const at = curve.moves[place];
  button.onclick = () => showSource(button.textContent, { ...data.sources[curve.source], moves: [at, at] }, data.logs);
}
