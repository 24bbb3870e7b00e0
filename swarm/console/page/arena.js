// The arena from above: compartments, cells, what was learnt, trails, paths, visits, robots.

import { arrow, label, line, prepared } from "./canvas.js";
import { colours, robotColour, skirtColour } from "./colours.js";
import { drawBest } from "./q_table.js";
import { COLUMNS, ROWS } from "./run.js";

const ROBOT_M = 0.037; // an e-puck's radius
const SKIRT_M = 0.05; // of the paper skirt around a demonstrator
const VIEW_RAD = (53 * Math.PI) / 180; // an e-puck camera's field of view
const MARGIN_PX = 6;
const FINE_PX = 8; // of a cell: below it lines and letters would be a grey blur

/** Draws the arena; `still` keeps what does not move between two frames. */
export class Arena {
  /** `choose` is called with a learner whose compartment is pressed. */
  constructor(canvas, choose) {
    this.canvas = canvas;
    canvas.addEventListener("click", (event) => this.#choose(event, choose));
    this.still = document.createElement("canvas");
    this.stillOf = "";
  }

  /** From metres to pixels, for an arena that fills the canvas as far as its shape allows. */
  #fit(arena, width, height) {
    this.scale = Math.min((width - 2 * MARGIN_PX) / arena.width_m, (height - 2 * MARGIN_PX) / arena.height_m);
    this.left = (width - arena.width_m * this.scale) / 2;
    this.bottom = (height + arena.height_m * this.scale) / 2;
  }

  #choose(event, choose) {
    const [x, y] = [(event.offsetX - this.left) / this.scale, (this.bottom - event.offsetY) / this.scale];
    const robot = this.robots?.find((each) => each.west_m <= x && x <= each.east_m && each.south_m <= y && y <= each.north_m);
    if (robot?.role === "learner") choose(robot.id);
  }

  #at = ([x, y]) => [this.left + x * this.scale, this.bottom - y * this.scale];

  draw(run, nowMs, options) {
    const { context, width, height } = prepared(this.canvas);
    if (!run.about || width === 0) return;
    this.robots = run.about.robots;
    this.#fit(run.about.arena, width, height);
    this.#drawStill(run, width, height);
    context.drawImage(this.still, 0, 0, width, height);
    if (!run.frame) return;
    this.#drawChosen(context, run.robot(run.state.selected));
    if (options.heat) this.#drawLearnt(context, run);
    for (const robot of run.about.robots) {
      const now = run.frame.robots[robot.id];
      if (options.trails) this.#drawTrail(context, run, robot);
      if (now.path?.moves.length) this.#drawPath(context, run, robot, now.path);
    }
    for (const robot of run.about.robots) {
      const pose = run.poseNow(robot.id, nowMs);
      if (!pose) continue;
      const now = run.frame.robots[robot.id];
      if (now.visit) this.#drawVisit(context, run, robot, pose, now.visit, nowMs);
      this.#drawRobot(context, run, robot, pose, now);
    }
    this.#drawNames(context, run, nowMs);
  }

  #drawStill(run, width, height) {
    const theme = colours();
    const drawn = `${width}x${height} ${devicePixelRatio} ${theme.floor} ${run.about.name} ${run.about.robots.length}`;
    if (drawn === this.stillOf) return;
    this.stillOf = drawn;
    this.still.width = this.canvas.width;
    this.still.height = this.canvas.height;
    const context = this.still.getContext("2d");
    context.scale(devicePixelRatio || 1, devicePixelRatio || 1);
    const { width_m: widthM, height_m: heightM } = run.about.arena;
    const [left, top] = this.#at([0, heightM]);
    context.fillStyle = theme.floor;
    context.beginPath();
    context.roundRect(left, top, widthM * this.scale, heightM * this.scale, 8);
    context.fill();
    this.#drawScale(context, theme, left, heightM);
    for (const robot of run.about.robots) this.#drawCompartment(context, run, robot, theme);
  }

  #drawScale(context, theme, left) {
    const [, y] = this.#at([0, 0.07]);
    context.strokeStyle = context.fillStyle = theme.quiet;
    context.lineWidth = 1.5;
    line(context, [[left + 12, y], [left + 12 + this.scale / 2, y]]);
    context.font = "11px system-ui, sans-serif";
    context.fillText("0.5 m", left + 16 + this.scale / 2, y + 4);
  }

  #drawCompartment(context, run, robot, theme) {
    const { columns, rows, cell_m: side } = run.about.arena;
    const [left, top] = this.#at([robot.west_m, robot.north_m]);
    const cell = side * this.scale;
    context.fillStyle = theme.cell;
    context.fillRect(left, top, columns * cell, rows * cell);
    context.strokeStyle = theme["cell-line"];
    context.lineWidth = 1;
    if (cell < FINE_PX) {
      context.strokeStyle = theme.wall;
      context.lineWidth = 1;
      context.strokeRect(left, top, columns * cell, rows * cell);
      return;
    }
    for (let column = 1; column < columns; column++) line(context, [[left + column * cell, top], [left + column * cell, top + rows * cell]]);
    for (let row = 1; row < rows; row++) line(context, [[left, top + row * cell], [left + columns * cell, top + row * cell]]);
    context.strokeStyle = theme.wall;
    context.lineWidth = 2;
    context.strokeRect(left, top, columns * cell, rows * cell);
    context.font = `600 ${Math.max(9, Math.min(14, cell * 0.7))}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = theme.quiet;
    context.fillText("S", left + cell / 2, top + cell / 2);
    context.fillText("G", left + (columns - 0.5) * cell, top + (rows - 0.5) * cell);
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
  }

  /** The best value of every cell as a tint, in the compartments of the learners whose tables are known. */
  #drawLearnt(context, run) {
    const { columns, cell_m: side } = run.about.arena;
    for (const [id, learner] of run.heat) {
      const robot = run.robot(id);
      const [left, top] = this.#at([robot.west_m, robot.north_m]);
      drawBest(context, learner.q_table, columns, left, top, side * this.scale, 0.55);
    }
  }

  /** The compartment of the robot whose learning is shown beside. */
  #drawChosen(context, robot) {
    if (!robot) return;
    const [left, top] = this.#at([robot.west_m, robot.north_m]);
    const side = [(robot.east_m - robot.west_m) * this.scale, (robot.north_m - robot.south_m) * this.scale];
    context.strokeStyle = colours().accent;
    context.lineWidth = 3;
    context.strokeRect(left, top, ...side);
  }

  #drawTrail(context, run, robot) {
    const trail = run.trails.get(robot.id) ?? [];
    context.strokeStyle = robotColour(run.number(robot.id));
    context.lineWidth = 2;
    context.lineJoin = context.lineCap = "round";
    const third = Math.ceil(trail.length / 3);
    for (let part = 0; part < 3; part++) {
      context.globalAlpha = 0.2 + 0.25 * part;
      const piece = trail.slice(part * third, (part + 1) * third + 1).map(([, x, y]) => this.#at([x, y]));
      line(context, piece);
    }
    context.globalAlpha = 1;
  }

  /** The path that is being enacted, from the cell where its replay began: made moves solid, the others dashed. */
  #drawPath(context, run, robot, path) {
    const theme = colours();
    const { columns, rows } = run.about.arena;
    let [column, row] = [path.from % columns, Math.floor(path.from / columns)];
    const cells = [[column, row]];
    for (const move of path.moves) {
      const [nextColumn, nextRow] = [column + COLUMNS[move], row + ROWS[move]];
      if (nextColumn < 0 || nextRow < 0 || nextColumn >= columns || nextRow >= rows) break;
      [column, row] = [nextColumn, nextRow];
      cells.push([column, row]);
    }
    const points = cells.map(([c, r]) => this.#at(run.centre(robot, r * columns + c)));
    const done = Math.min(path.done, points.length - 1);
    context.strokeStyle = context.fillStyle = theme.path;
    context.lineWidth = 4;
    context.lineCap = "round";
    line(context, points.slice(0, done + 1));
    context.setLineDash([2, 7]);
    line(context, points.slice(done));
    context.setLineDash([]);
    points.forEach(([x, y], at) => {
      context.beginPath();
      context.arc(x, y, at === 0 ? 4.5 : 3, 0, 2 * Math.PI);
      context.fill();
    });
  }

  /** The field of view of a robot that watches, and where it found whom it watches. */
  #drawVisit(context, run, robot, pose, visit, nowMs) {
    const theme = colours();
    const [x, y] = this.#at(pose);
    const reach = 2 * this.scale;
    context.save();
    this.#clipToFloor(context, run.about.arena);
    context.globalAlpha = 0.16;
    context.fillStyle = robotColour(run.number(robot.id));
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, reach, -pose[2] - VIEW_RAD / 2, -pose[2] + VIEW_RAD / 2);
    context.closePath();
    if (visit.phase === "watching") context.fill();
    context.restore();
    if (visit.sighting?.length) this.#drawSighting(context, pose, visit.sighting, theme);
    const other = visit.whom && run.poseNow(visit.whom, nowMs);
    if (other && visit.phase === "watching") {
      context.strokeStyle = theme.quiet;
      context.lineWidth = 1;
      context.setLineDash([4, 4]);
      line(context, [[x, y], this.#at(other)]);
      context.setLineDash([]);
    }
  }

  #clipToFloor(context, { width_m: widthM, height_m: heightM }) {
    context.beginPath();
    context.rect(...this.#at([0, heightM]), widthM * this.scale, heightM * this.scale);
    context.clip();
  }

  #drawSighting(context, pose, [range, bearing], theme) {
    const angle = pose[2] + bearing;
    const [x, y] = this.#at([pose[0] + range * Math.cos(angle), pose[1] + range * Math.sin(angle)]);
    context.strokeStyle = theme.ink;
    context.lineWidth = 2;
    for (const side of [-1, 1]) line(context, [[x - 6, y - 6 * side], [x + 6, y + 6 * side]]);
  }

  #drawRobot(context, run, robot, pose, now) {
    const theme = colours();
    const [x, y] = this.#at(pose);
    const radius = Math.max(5, ROBOT_M * this.scale);
    if (robot.skirt) {
      context.fillStyle = skirtColour(robot.skirt);
      context.beginPath();
      context.arc(x, y, Math.max(7.5, SKIRT_M * this.scale), 0, 2 * Math.PI);
      context.fill();
    }
    context.fillStyle = robotColour(run.number(robot.id));
    context.strokeStyle = now.pose_age_s > 1 ? theme.bad : theme.panel;
    context.lineWidth = now.pose_age_s > 1 ? 3 : 1.5;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.strokeStyle = context.fillStyle = "#ffffff";
    context.lineWidth = 2;
    const [ahead, behind] = [radius * 0.85, radius * 0.5];
    const [cos, sin] = [Math.cos(pose[2]), -Math.sin(pose[2])];
    arrow(context, [x - behind * cos, y - behind * sin], [x + ahead * cos, y + ahead * sin], radius * 0.75);
  }

  #drawNames(context, run, nowMs) {
    if (run.about.robots.length > 12) return;
    const theme = colours();
    context.font = "600 12px system-ui, sans-serif";
    for (const robot of run.about.robots) {
      const pose = run.poseNow(robot.id, nowMs);
      if (!pose) continue;
      const now = run.frame.robots[robot.id];
      const [x, y] = this.#at(pose);
      const what = now.visit ? `watches ${now.visit.whom}` : now.path ? `imitates path ${now.path.number}` : "";
      const text = what ? `${robot.id} ${what}` : robot.id;
      const right = x + 14 + context.measureText(text).width > this.canvas.clientWidth;
      context.textAlign = right ? "right" : "left";
      label(context, text, right ? x - 13 : x + 13, y - 9, theme.ink, theme.cell);
    }
    context.textAlign = "left";
  }
}
