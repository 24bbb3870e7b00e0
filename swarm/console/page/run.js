// What this page knows of the run: what stands still, what grows, and the moment that is shown.

const TRAIL_S = 40;
const MOST_TRAIL_POINTS = 800;

export const COMPASS = ["E", "SE", "S", "SW", "W", "NW", "N", "NE"];
export const COLUMNS = [1, 1, 0, -1, -1, -1, 0, 1];
export const ROWS = [0, 1, 1, 1, 0, -1, -1, -1];

/** A run as far as it has been told. `take` returns the kind of what a message changed. */
export class Run {
  constructor() {
    this.about = null;
    this.state = {};
    this.frame = null;
    this.before = null;
    this.arrivedMs = 0;
    this.intervalMs = 50;
    this.learner = null;
    this.observation = null;
    this.heat = new Map();
    this.begin();
  }

  begin() {
    this.curves = new Map();
    this.visits = new Map();
    this.events = [];
    this.trails = new Map();
    this.frame = this.before = this.learner = null;
    this.heat.clear();
  }

  take(message, nowMs) {
    if (message.kind === "about") {
      this.begin();
      this.about = message;
    } else if (message.kind === "state") this.state = message;
    else if (message.kind === "frame") this.#takeFrame(message, nowMs);
    else if (message.kind === "growth") this.#grow(message);
    else if (message.kind === "learner") this.#takeLearner(message);
    else if (message.kind === "observation") this.observation = message;
    return message.kind;
  }

  number(id) {
    return this.about.robots.findIndex((robot) => robot.id === id);
  }

  robot(id) {
    return this.about.robots[this.number(id)];
  }

  /** The centre of a cell of a robot's compartment, in metres. */
  centre(robot, state) {
    const { columns, cell_m: side } = this.about.arena;
    return [robot.west_m + ((state % columns) + 0.5) * side, robot.north_m - (Math.floor(state / columns) + 0.5) * side];
  }

  /** A robot's place between the last two frames, so that it glides. */
  poseNow(id, nowMs) {
    const now = this.frame?.robots[id]?.pose;
    const old = this.before?.robots[id]?.pose;
    if (!now || !old || this.frame.jumped || Math.hypot(now[0] - old[0], now[1] - old[1]) > 0.4) return now;
    const share = Math.min(1, (nowMs - this.arrivedMs) / this.intervalMs);
    const turn = Math.atan2(Math.sin(now[2] - old[2]), Math.cos(now[2] - old[2]));
    return [old[0] + (now[0] - old[0]) * share, old[1] + (now[1] - old[1]) * share, old[2] + turn * share];
  }

  /** Whether a robot is still gliding from one frame to the next. */
  isGliding(nowMs) {
    return this.frame !== null && nowMs - this.arrivedMs < this.intervalMs;
  }

  #takeFrame(frame, nowMs) {
    this.intervalMs = Math.min(300, Math.max(30, nowMs - this.arrivedMs));
    this.arrivedMs = nowMs;
    this.before = frame.jumped ? null : this.frame;
    this.frame = frame;
    for (const [id, robot] of Object.entries(frame.robots)) {
      const kept = frame.jumped ? [] : (this.trails.get(id) ?? []);
      kept.push(...robot.trail);
      const span = Math.max(TRAIL_S, 3 * (this.state.speed ?? 1));
      const first = kept.findIndex(([tS]) => tS > frame.t_s - span);
      this.trails.set(id, first < 0 ? [] : kept.slice(Math.max(first, kept.length - MOST_TRAIL_POINTS)));
    }
  }

  #takeLearner(learner) {
    this.learner = learner;
    this.heat.set(learner.robot, learner);
  }

  #grow({ curves, visits, events }) {
    for (const [id, points] of Object.entries(curves)) this.curves.set(id, (this.curves.get(id) ?? []).concat(points));
    for (const [id, new_] of Object.entries(visits)) this.visits.set(id, (this.visits.get(id) ?? []).concat(new_));
    this.events.push(...events);
  }
}

/** Seconds as 1:02:03. */
export function clock(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  const two = (value) => String(value).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

/** Seconds in words for a plan: 46 min, 2.5 h. */
export function inWords(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}
