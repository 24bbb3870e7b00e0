// What stands before the camera of a robot that watches, drawn anew from poses: a log keeps no pictures, only their
// hashes and what was seen in them. Beside it, what the observer itself made of the frame: the sighting.

import { line, prepared } from "./canvas.js";
import { colours, skirtColour } from "./colours.js";

const HEIGHT_M = 0.028; // of an e-puck's camera above the floor, as in deploy/cameras
const FORWARD_M = 0.03; // of the robot's turning axis
const VIEW_RAD = (53 * Math.PI) / 180;
const SKIRT = { radiusM: 0.0355, bottomM: 0.004, topM: 0.042 };
const WALL_M = 0.1; // looks only
const NEAREST_M = 0.03; // what is nearer is not drawn

/** A pinhole camera at a robot's pose; `at` gives pixels and depth of a point of the arena, null behind it. */
function pinhole([x, y, theta], width, height) {
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  const focal = width / 2 / Math.tan(VIEW_RAD / 2);
  const [eyeX, eyeY] = [x + FORWARD_M * cos, y + FORWARD_M * sin];
  const local = (px, py) => [cos * (px - eyeX) + sin * (py - eyeY), -sin * (px - eyeX) + cos * (py - eyeY)];
  const project = (depth, aside, up) => [width / 2 - (focal * aside) / depth, height / 2 - (focal * (up - HEIGHT_M)) / depth];
  return { focal, local, project, width, height };
}

/** Draw the view from `own` on `other` in the compartment of the robot `whom`; `sighting` is [range, bearing], [] or null. */
export function drawCamera(canvas, { own, other, whom, sighting }) {
  const { context, width, height } = prepared(canvas);
  if (width === 0) return;
  const view = framed(context, width, height);
  context.save();
  context.beginPath();
  context.roundRect(view.left, view.top, view.width, view.height, 6);
  context.clip();
  context.translate(view.left, view.top);
  const camera = pinhole(own, view.width, view.height);
  drawRoom(context, camera);
  drawWalls(context, camera, whom);
  if (other) drawRobot(context, camera, other, skirtColour(whom.skirt));
  if (sighting?.length) drawSighting(context, camera, sighting);
  context.restore();
}

/** A message where there is no view. */
export function drawNoCamera(canvas, text) {
  const { context, width, height } = prepared(canvas);
  const theme = colours();
  context.fillStyle = theme.floor;
  context.beginPath();
  context.roundRect(0, 0, width, height, 6);
  context.fill();
  context.fillStyle = theme.quiet;
  context.font = "13px system-ui, sans-serif";
  context.textAlign = "center";
  context.fillText(text, width / 2, height / 2);
  context.textAlign = "left";
}

/** The largest picture of 4 by 3 that fits. */
function framed(context, width, height) {
  const scale = Math.min(width / 4, height / 3);
  return { left: (width - 4 * scale) / 2, top: (height - 3 * scale) / 2, width: 4 * scale, height: 3 * scale };
}

function drawRoom(context, { width, height }) {
  const sky = context.createLinearGradient(0, 0, 0, height / 2);
  sky.addColorStop(0, "#c9d3df");
  sky.addColorStop(1, "#e9edf2");
  context.fillStyle = sky;
  context.fillRect(0, 0, width, height / 2);
  const floor = context.createLinearGradient(0, height / 2, 0, height);
  floor.addColorStop(0, "#b9b2a4");
  floor.addColorStop(1, "#8f8879");
  context.fillStyle = floor;
  context.fillRect(0, height / 2, width, height / 2);
}

/** The two walls that face a robot which looks in from the south-east corner, and the cells' lines on the floor. */
function drawWalls(context, camera, room) {
  const corners = [[room.west_m, room.south_m], [room.west_m, room.north_m], [room.east_m, room.north_m]];
  const shades = ["#dfe3e8", "#cdd4dc"];
  for (let side = 0; side < 2; side++) {
    const outline = clipped(camera, corners[side], corners[side + 1]);
    if (!outline) continue;
    const [a, b] = outline;
    context.fillStyle = shades[side];
    context.beginPath();
    [[a, 0], [b, 0], [b, WALL_M], [a, WALL_M]].forEach(([[depth, aside], up], at) => {
      const [x, y] = camera.project(depth, aside, up);
      at ? context.lineTo(x, y) : context.moveTo(x, y);
    });
    context.closePath();
    context.fill();
  }
  context.strokeStyle = "rgb(40 40 40 / 22%)";
  context.lineWidth = 1;
  for (let part = 0; part <= 10; part++) {
    const x = room.west_m + ((room.east_m - room.west_m) * part) / 10;
    const y = room.south_m + ((room.north_m - room.south_m) * part) / 10;
    floorLine(context, camera, [x, room.south_m], [x, room.north_m]);
    floorLine(context, camera, [room.west_m, y], [room.east_m, y]);
  }
}

function floorLine(context, camera, from, to) {
  const ends = clipped(camera, from, to);
  if (ends) line(context, ends.map(([depth, aside]) => camera.project(depth, aside, 0)));
}

/** The part of a line on the floor that lies before the camera, in its own frame. */
function clipped(camera, from, to) {
  const [a, b] = [camera.local(...from), camera.local(...to)];
  if (a[0] < NEAREST_M && b[0] < NEAREST_M) return null;
  const cut = (behind, before) => {
    const share = (NEAREST_M - behind[0]) / (before[0] - behind[0]);
    return [NEAREST_M, behind[1] + share * (before[1] - behind[1])];
  };
  return [a[0] < NEAREST_M ? cut(a, b) : a, b[0] < NEAREST_M ? cut(b, a) : b];
}

/** A skirt with the robot's board on it, as an upright cylinder. */
function drawRobot(context, camera, [x, y], skirt) {
  const [depth, aside] = camera.local(x, y);
  if (depth < NEAREST_M + SKIRT.radiusM) return;
  const [centre, bottom] = camera.project(depth, aside, SKIRT.bottomM);
  const [, top] = camera.project(depth, aside, SKIRT.topM);
  const half = (camera.focal * SKIRT.radiusM) / depth;
  context.fillStyle = "rgb(20 20 20 / 30%)";
  context.beginPath();
  context.ellipse(centre, bottom, half * 1.1, Math.max(1, half * 0.22), 0, 0, 2 * Math.PI);
  context.fill();
  const round = context.createLinearGradient(centre - half, 0, centre + half, 0);
  round.addColorStop(0, "#00000080");
  round.addColorStop(0.35, "#ffffff30");
  round.addColorStop(1, "#00000090");
  for (const fill of [skirt, round]) {
    context.fillStyle = fill;
    context.fillRect(centre - half, top, 2 * half, bottom - top);
  }
  context.fillStyle = "#2f3238";
  context.fillRect(centre - half * 0.93, top - (bottom - top) * 0.36, 2 * half * 0.93, (bottom - top) * 0.36);
}

/** The sighting as a box: as wide and high as a skirt is at that range. */
function drawSighting(context, camera, [range, bearing]) {
  const [depth, aside] = [Math.max(NEAREST_M, range * Math.cos(bearing)), range * Math.sin(bearing)];
  const [x, top] = camera.project(depth, aside, SKIRT.topM);
  const [, bottom] = camera.project(depth, aside, SKIRT.bottomM);
  const half = (camera.focal * SKIRT.radiusM) / depth;
  for (const [colour, width] of [["#ffffff", 4], ["#17202c", 1.8]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.strokeRect(x - half - 3, top - 3, 2 * half + 6, bottom - top + 6);
  }
}
