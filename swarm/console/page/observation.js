// One visit in a dialog: every frame's sighting beside the tracked place, and the moves that were made of them.

import { drawCamera } from "./camera.js";
import { line, prepared } from "./canvas.js";
import { colours, robotColour } from "./colours.js";
import { byId, element, say } from "./dom.js";

export class Observation {
  constructor() {
    this.dialog = byId("observation");
    this.slider = byId("observation-frame");
    this.slider.addEventListener("input", () => this.draw());
    addEventListener("resize", () => this.dialog.open && this.draw());
  }

  show(run) {
    this.run = run;
    const { robot, visit, whom, looks } = run.observation;
    say("observation-title", `Visit ${visit}: ${robot} watched ${whom}`);
    this.slider.max = String(Math.max(0, looks.length - 1));
    this.slider.value = "0";
    byId("observation-moves").replaceChildren(...this.#moves(run.observation));
    byId("observation-legend").replaceChildren(...legend());
    if (!this.dialog.open) this.dialog.showModal();
    this.draw();
  }

  draw() {
    const { looks } = this.run.observation;
    const chosen = Number(this.slider.value);
    this.#drawMap(chosen);
    const look = looks[chosen];
    if (!look) return;
    const found = look.seen ? [look.range_m, look.bearing_rad] : [];
    const whom = this.run.robot(this.run.observation.whom);
    if (look.own) drawCamera(byId("observation-camera"), { own: look.own, other: look.tracked, whom, sighting: found });
    const error = look.seen && look.tracked ? Math.hypot(look.seen[0] - look.tracked[0], look.seen[1] - look.tracked[1]) * 100 : null;
    const seen = look.seen
      ? `seen at ${look.range_m.toFixed(2)} m, ${((look.bearing_rad * 180) / Math.PI).toFixed(1)} degrees; ${error?.toFixed(1) ?? "?"} cm from its tracked place`
      : `not seen: ${look.why_not}`;
    say("observation-words", `${chosen + 1} of ${looks.length}: ${seen}. Frame ${look.hash}`);
  }

  #drawMap(chosen) {
    const canvas = byId("observation-map");
    const { context, width, height } = prepared(canvas);
    const theme = colours();
    const { looks, smoothed, whom } = this.run.observation;
    const room = this.run.robot(whom);
    const side = room.east_m - room.west_m;
    const scale = Math.min(width, height) / (side * 1.24);
    const left = (width - side * scale) / 2;
    const top = (height - side * scale) / 2;
    const at = ([x, y]) => [left + (x - room.west_m) * scale, top + (room.north_m - y) * scale];
    context.fillStyle = theme.floor;
    context.fillRect(0, 0, width, height);
    context.fillStyle = theme.cell;
    context.fillRect(left, top, side * scale, side * scale);
    const { columns, rows } = this.run.about.arena;
    context.strokeStyle = theme["cell-line"];
    for (let column = 0; column <= columns; column++) line(context, [[left + (column * side * scale) / columns, top], [left + (column * side * scale) / columns, top + side * scale]]);
    for (let row = 0; row <= rows; row++) line(context, [[left, top + (row * side * scale) / rows], [left + side * scale, top + (row * side * scale) / rows]]);
    context.strokeStyle = theme.wall;
    context.lineWidth = 2;
    context.strokeRect(left, top, side * scale, side * scale);
    context.strokeStyle = robotColour(this.run.number(whom));
    line(context, looks.filter((look) => look.tracked).map((look) => at(look.tracked)));
    context.strokeStyle = theme.path;
    context.lineWidth = 3;
    line(context, smoothed.map(at));
    context.fillStyle = theme.ink;
    for (const look of looks.filter((each) => each.seen)) dot(context, at(look.seen), 2);
    const look = looks[chosen];
    if (!look) return;
    if (look.own) dot(context, at(look.own), 6);
    if (look.seen && look.own) {
      context.setLineDash([4, 4]);
      context.strokeStyle = theme.ink;
      context.lineWidth = 1.5;
      line(context, [at(look.own), at(look.seen)]);
      context.setLineDash([]);
      dot(context, at(look.seen), 5);
    }
  }

  /** What was copied, what of it was remembered, and what the demonstrator really did. */
  #moves({ moves, confidences, window: kept, true_moves: real, edit_distance: wrong, reason }) {
    const first = firstOf(moves, kept);
    const copied = moves.map((move, at) =>
      element("span", { "data-kept": String(first >= 0 && at >= first && at < first + kept.length), title: `confidence ${confidences[at] ?? "?"}` }, move));
    const found = [element("h3", {}, "Copied moves, those that were remembered framed"), element("div", { class: "moves" }, ...copied)];
    if (reason) found.push(element("p", {}, `Nothing was copied: ${reason}`));
    if (real) {
      const verdict = wrong === 0 ? "the same" : `${wrong} edits away`;
      found.push(element("h3", {}, `Its real moves: ${verdict}`), element("div", { class: "moves" }, ...real.map((move) => element("span", {}, move))));
    }
    return found;
  }
}

/** Where a list begins within another one; -1 if it does not. */
function firstOf(moves, kept) {
  if (!kept.length) return -1;
  return moves.findIndex((_, at) => kept.every((move, offset) => moves[at + offset] === move));
}

function dot(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

function legend() {
  return ["\u2022 sightings and observer", "thick line: smoothed places", "thin line: its tracked places"].map((text) => element("span", {}, text));
}
