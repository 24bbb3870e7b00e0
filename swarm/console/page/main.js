// The page: messages change the run, and what has changed is drawn at the screen's next frame.

import { Arena } from "./arena.js";
import { drawCamera, drawNoCamera } from "./camera.js";
import { connect } from "./connection.js";
import { Curves } from "./curves.js";
import { byId, say } from "./dom.js";
import { Memory } from "./memory.js";
import { Observation } from "./observation.js";
import { drawHealth, drawLearners, drawPlan, drawVisits, Events, pressLearner } from "./panels.js";
import { Player } from "./player.js";
import { QTable } from "./q_table.js";
import { clock, Run } from "./run.js";
import { Steering } from "./steering.js";

const run = new Run();
const ask = connect(hear, tell);
const arena = new Arena(byId("arena"), choose);
const qTable = new QTable(byId("q-table"), byId("q-words"));
const memory = new Memory(byId("memory"), ask);
const curves = new Curves(byId("curves"), byId("curves-legend"));
const player = new Player(run, ask);
const events = new Events((tS) => player.seek(tS));
const observation = new Observation();
const steering = new Steering(run, ask);
const changed = new Set();
let trouble = "connecting";

/** What a message changes has to be drawn again. */
const DRAWS = {
  about: ["all"],
  state: ["player", "source", "learner", "steering", "arena"],
  frame: ["arena", "frame", "slow"],
  growth: ["curves", "visits", "events", "player"],
  learner: ["learner", "arena"],
};

function hear(message) {
  if (message.kind === "about") events.drawn = -1;
  const kind = run.take(message, performance.now());
  if (kind === "observation") observation.show(run);
  if (kind === "answer") steering.hear(message);
  for (const part of DRAWS[kind] ?? []) changed.add(part);
}

function tell(words) {
  trouble = words;
  changed.add("source");
}

function choose(robot) {
  ask({ ask: "select", robot });
}

const draws = {
  arena: (nowMs) => arena.draw(run, nowMs, { heat: byId("show-heat").checked, trails: byId("show-trails").checked }),
  frame: (nowMs) => {
    drawPlan(run);
    drawHealth(run);
    events.draw(run);
    player.draw();
    memory.draw(run);
    drawCameraOf();
  },
  slow: () => {
    curves.draw(run);
    qTable.draw(run);
    drawArenaWords();
  },
  learner: () => {
    pressLearner(run);
    qTable.draw(run);
    memory.draw(run);
    drawVisits(run, (tS) => player.seek(tS));
  },
  curves: () => curves.draw(run),
  visits: () => drawVisits(run, (tS) => player.seek(tS)),
  events: () => events.draw(run),
  player: () => {
    player.draw();
    player.drawTicks();
  },
  source: drawSource,
  steering: () => run.about && steering.draw(),
};

/** The curves grow slowly: they are drawn four times a second, the robots at every frame. */
const SLOW_MS = 250;
let slowDueMs = 0;

/** The arena in words, for who does not see it. */
function drawArenaWords() {
  const words = run.about.robots.map((robot) => {
    const now = run.frame.robots[robot.id];
    const what = now.visit ? `watches ${now.visit.whom}` : now.path ? `imitates path ${now.path.number}` : now.activity;
    return `${robot.id}: ${what || "nothing known"}, ${now.moves} moves`;
  });
  say("arena-words", `At ${clock(run.frame.t_s)}. ${words.join(". ")}`);
}

/** The camera of the robot that watches: of the chosen one, or else of any. */
function drawCameraOf() {
  const watching = ([, now]) => now.visit?.phase === "watching" && now.pose;
  const robots = Object.entries(run.frame.robots);
  const found = robots.find(([id, now]) => id === run.state.selected && watching([id, now])) ?? robots.find(watching);
  if (!found) {
    say("camera-words", plannedVisit());
    drawNoCamera(byId("camera"), "nobody watches now");
    return;
  }
  const [id, { visit }] = found;
  const seen = visit.sighting === null ? "redrawn from poses" : visit.sighting.length ? "with the sighting" : "not seen in this frame";
  say("camera-words", `${id} watches ${visit.whom}: ${seen}`);
  drawCamera(byId("camera"), { own: run.frame.robots[id].pose, other: run.frame.robots[visit.whom]?.pose, whom: run.robot(visit.whom), sighting: visit.sighting });
}

/** When the chosen robot will watch again, by the rules of the experiment. */
function plannedVisit() {
  const { about, state, frame } = run;
  const robot = run.robot(state.selected);
  if (!robot?.watches) return `${state.selected} watches nobody`;
  const done = (run.visits.get(robot.id) ?? []).filter(([tS, , phase]) => phase === "done" && tS <= frame.t_s);
  const paths = done.filter(([, , , path]) => path > 0).length;
  if (paths >= about.learning.capacity) return `its memory is full: it watches no more`;
  return `visit ${done.length + 1} after ${done.length * about.visits.every_tracks} journeys; ${frame.robots[robot.id].tracks} are made`;
}

function drawSource() {
  say("source", trouble || run.state.source || "");
  byId("source").dataset.trouble = String(Boolean(trouble || run.state.trouble));
  say("role", run.state.may_steer ? "you may steer" : "you may look");
}

/** Everything, for a new run or another size. */
function drawAll(nowMs) {
  if (!run.about) return;
  drawLearners(run, choose);
  curves.begin(run);
  memory.drawn = "";
  events.drawn = -1;
  if (run.frame) for (const draw of Object.values(draws)) draw(nowMs);
}

function tick(nowMs) {
  if (changed.has("all")) {
    changed.clear();
    drawAll(nowMs);
  }
  const isDue = (part) => part !== "slow" || nowMs >= slowDueMs;
  const parts = [...changed].filter((part) => isDue(part) && (run.frame || part === "source" || part === "steering"));
  if (parts.includes("slow")) slowDueMs = nowMs + SLOW_MS;
  for (const part of parts) {
    changed.delete(part);
    draws[part](nowMs);
  }
  if (run.isGliding(nowMs)) changed.add("arena");
  requestAnimationFrame(tick);
}

for (const id of ["show-heat", "show-trails"]) byId(id).addEventListener("change", () => changed.add("arena"));
byId("help-button").addEventListener("click", () => byId("help").showModal());
addEventListener("resize", () => changed.add("all"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => changed.add("all"));
requestAnimationFrame(tick);
