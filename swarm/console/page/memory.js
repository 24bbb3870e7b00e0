// The memory of the chosen learner: each path, its R as it was over time, where it came from.

import { prepared } from "./canvas.js";
import { colours } from "./colours.js";
import { byId, element, say } from "./dom.js";

export class Memory {
  constructor(list, ask) {
    this.list = list;
    this.ask = ask;
    this.drawn = "";
    this.lines = [];
  }

  draw(run) {
    const learner = run.learner;
    const active = run.frame?.robots[run.state.selected]?.path?.number ?? 0;
    if (!learner || learner.robot !== run.state.selected) return;
    const memory = learner.memory;
    const drawn = JSON.stringify([learner.robot, active, memory.map((path) => [path.number, path.replayed, path.ratio])]);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    say("memory-count", memory.length ? `${memory.length} of ${run.about.learning.capacity} paths` : "");
    byId("memory-empty").hidden = memory.length > 0;
    const top = this.list.scrollTop;
    this.lines = [];
    this.list.replaceChildren(...memory.map((path) => this.#entry(run, learner, path, path.number === active)));
    this.list.scrollTop = top;
    this.lines.forEach(([canvas, path]) => drawRatios(canvas, path.ratios, run.about.moves));
  }

  #entry(run, learner, path, isActive) {
    const line = element("canvas", { role: "img", "aria-label": `R of path ${path.number} over time` });
    this.lines.push([line, path]);
    const wrong = path.wrong === null ? "" : path.wrong === 0 ? ", perfect" : `, ${path.wrong} wrong`;
    const from = path.source === "camera" ? `visit ${path.visit}${wrong}` : path.source;
    const source = path.source === "camera"
      ? element("button", { type: "button", title: "Show the frames of this observation", onclick: () => this.ask({ ask: "observation", robot: learner.robot, visit: path.visit }) }, from)
      : element("span", {}, from);
    return element(
      "li",
      { "data-active": String(isActive) },
      element("div", { class: "memory-top" },
        element("span", { class: "memory-moves" }, `${path.number}  ${path.moves.join(" ")}`),
        element("span", { class: "memory-ratio" }, `R ${path.ratio.toFixed(2)}`)),
      line,
      element("div", { class: "memory-more" }, source,
        element("span", { title: `completed ${path.completed}, raised Q ${path.improved}` }, `${path.replayed} tries, p ${path.p_imitate.toFixed(2)}`)),
    );
  }
}

/** R, from 0 to 1, over the trial's moves. */
function drawRatios(canvas, ratios, moves) {
  const { context, width, height } = prepared(canvas);
  const theme = colours();
  const at = ([move, ratio]) => [(move / moves) * width, height - 2 - ratio * (height - 4)];
  context.strokeStyle = theme.line;
  context.beginPath();
  context.moveTo(0, height - 1.5);
  context.lineTo(width, height - 1.5);
  context.stroke();
  context.strokeStyle = theme.path;
  context.lineWidth = 1.6;
  context.beginPath();
  ratios.forEach((point, number) => {
    const [x, y] = at(point);
    number ? context.lineTo(x, y) : context.moveTo(x, y);
  });
  context.stroke();
  if (ratios.length === 1) {
    const [x, y] = at(ratios[0]);
    context.fillStyle = theme.path;
    context.fillRect(x - 1.5, y - 1.5, 3, 3);
  }
}
