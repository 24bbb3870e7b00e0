// The learning curves of all learners as they grow, and the mean of each condition of several.

import { robotColour, robotDash } from "./colours.js";
import { plot } from "./plot.js";

const MOST_POINTS = 700; // of a line: more than a plot has pixels

export class Curves {
  constructor(canvas, legend) {
    this.canvas = canvas;
    this.legend = legend;
  }

  /** The legend: a sample of each line, and its name. */
  begin(run) {
    const entries = this.#lines(run).map(({ name, colour, dash }) => {
      const entry = document.createElement("span");
      const sample = document.createElement("canvas");
      sample.width = 44;
      sample.height = 12;
      sample.style.width = "22px";
      sample.style.height = "6px";
      const context = sample.getContext("2d");
      context.strokeStyle = colour;
      context.lineWidth = 5;
      context.setLineDash(dash.map((part) => part * 1.5));
      context.beginPath();
      context.moveTo(0, 6);
      context.lineTo(44, 6);
      context.stroke();
      entry.append(sample, document.createTextNode(name));
      return entry;
    });
    this.legend.replaceChildren(...entries);
  }

  draw(run) {
    if (!run.about) return;
    const tS = run.frame?.t_s ?? Infinity;
    const lines = this.#lines(run).flatMap(({ points, colour, dash }) => {
      const told = points.filter(([at]) => at <= tS);
      const toCome = points.slice(Math.max(0, told.length - 1));
      return [
        { points: thinned(toCome), colour, dash, width: 1.5, alpha: 0.25 },
        { points: thinned(told), colour, dash, width: 2.2 },
      ];
    });
    const { cap } = run.about.learning;
    plot(this.canvas, {
      lines: lines.map((each) => ({ ...each, points: each.points.map(([, move, length]) => [move, length]) })),
      xMax: run.about.moves,
      yMax: Math.min(cap, 105),
      xName: "moves",
      yName: "best path, moves",
      marks: [{ y: run.about.shortest, name: `shortest: ${run.about.shortest}` }],
    });
  }

  /** A line for each learner; for many, one for each condition. */
  #lines(run) {
    const learners = run.about.robots.filter((robot) => robot.role === "learner");
    if (learners.length <= 6)
      return learners.map((robot) => ({
        name: robot.condition === robot.id ? robot.id : `${robot.id} (${robot.condition})`,
        points: run.curves.get(robot.id) ?? [],
        colour: robotColour(run.number(robot.id)),
        dash: robotDash(run.number(robot.id)),
      }));
    const conditions = [...new Set(learners.map((robot) => robot.condition))];
    return conditions.map((condition, number) => {
      const members = learners.filter((robot) => robot.condition === condition);
      const points = mean(members.map((robot) => run.curves.get(robot.id) ?? []));
      return { name: `${condition} (mean of ${members.length})`, points, colour: robotColour(number), dash: robotDash(number) };
    });
  }
}

/** The mean of several curves at the moves that all of them have; the time is the latest. */
function mean(curves) {
  const count = Math.min(...curves.map((points) => points.length));
  return Array.from({ length: Math.max(0, count) }, (_, at) => [
    Math.max(...curves.map((points) => points[at][0])),
    curves[0][at][1],
    curves.reduce((sum, points) => sum + points[at][2], 0) / curves.length,
  ]);
}

function thinned(points) {
  const step = Math.max(1, Math.ceil(points.length / MOST_POINTS));
  return points.filter((_, at) => at % step === 0 || at === points.length - 1);
}

