// Lines over a number axis, with round numbers on both axes.

import { line, prepared } from "./canvas.js";
import { colours } from "./colours.js";

const LEFT_PX = 46;
const BOTTOM_PX = 22;
const TOP_PX = 8;
const RIGHT_PX = 12;

/** The step of 1, 2 or 5 times a power of ten that divides a span into about so many parts. */
function roundStep(span, parts) {
  const rough = span / parts;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((step) => step * power >= rough);
}

/** Draw lines: each has `points` [x, y], `colour`, and may have `dash`, `width`, `alpha`. `marks` are levels with names. */
export function plot(canvas, { lines, xMax, yMax, xName, yName, marks = [] }) {
  const { context, width, height } = prepared(canvas);
  if (width === 0 || !(xMax > 0) || !(yMax > 0)) return;
  const theme = colours();
  const inner = { left: LEFT_PX, top: TOP_PX, right: width - RIGHT_PX, bottom: height - BOTTOM_PX };
  const at = ([x, y]) => [
    inner.left + ((inner.right - inner.left) * x) / xMax,
    inner.bottom - ((inner.bottom - inner.top) * y) / yMax,
  ];
  drawAxes(context, theme, inner, at, xMax, yMax);
  drawNames(context, theme, inner, xName, yName);
  for (const mark of marks) drawMark(context, theme, inner, at, mark);
  context.save();
  context.beginPath();
  context.rect(inner.left, 0, inner.right - inner.left + RIGHT_PX, inner.bottom + 2);
  context.clip();
  context.lineJoin = "round";
  for (const each of lines) {
    context.globalAlpha = each.alpha ?? 1;
    context.strokeStyle = each.colour;
    context.lineWidth = each.width ?? 2;
    context.setLineDash(each.dash ?? []);
    line(context, each.points.map(at));
    context.setLineDash([]);
  }
  context.restore();
}

function drawAxes(context, theme, inner, at, xMax, yMax) {
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = theme.quiet;
  context.strokeStyle = theme.line;
  context.lineWidth = 1;
  context.textBaseline = "middle";
  context.textAlign = "right";
  const yStep = roundStep(yMax, 4);
  for (let y = 0; y <= yMax * 1.001; y += yStep) {
    const [, py] = at([0, y]);
    line(context, [[inner.left, py], [inner.right, py]]);
    context.fillText(String(Math.round(y * 100) / 100), inner.left - 6, py);
  }
  context.textBaseline = "top";
  context.textAlign = "center";
  const xStep = roundStep(xMax, Math.max(2, (inner.right - inner.left) / 90));
  for (let x = 0; x <= xMax * 1.001; x += xStep) {
    const [px] = at([x, 0]);
    if (px < inner.right - 24 || x === 0) context.fillText(x.toLocaleString("en"), px, inner.bottom + 6);
  }
}

function drawNames(context, theme, inner, xName, yName) {
  context.fillStyle = theme.quiet;
  context.textAlign = "right";
  context.textBaseline = "top";
  context.fillText(xName, inner.right + RIGHT_PX - 2, inner.bottom + 6);
  context.save();
  context.translate(2, (inner.top + inner.bottom) / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = "center";
  context.fillText(yName, 0, 0);
  context.restore();
}

function drawMark(context, theme, inner, at, { y, name }) {
  const [, py] = at([0, y]);
  context.strokeStyle = theme.quiet;
  context.setLineDash([3, 4]);
  line(context, [[inner.left, py], [inner.right, py]]);
  context.setLineDash([]);
  context.fillStyle = theme.quiet;
  context.textAlign = "right";
  context.textBaseline = "bottom";
  context.fillText(name, inner.right, py - 2);
}
