// The lists: robots to choose, visits, health, events, and the trial's plan.

import { robotColour } from "./colours.js";
import { byId, element, say } from "./dom.js";
import { clock, inWords } from "./run.js";

const STALE_S = 1; // a robot stands when its pose is older
const LOW_BATTERY_V = 3.4; // an e-puck's motors fail below it
const MOST_BUTTONS = 9; // as many as there are keys for
const MOST_EVENTS = 200; // in the list: the newest of those that have happened

/** A button for each learner; of many learners a list. */
export function drawLearners(run, choose) {
  const learners = run.about.robots.filter((robot) => robot.role === "learner");
  if (learners.length > MOST_BUTTONS) {
    const options = learners.map((robot) => element("option", { value: robot.id }, `${robot.id} (${robot.condition})`));
    const list = element("select", { "aria-label": "Robot", onchange: () => choose(list.value) }, ...options);
    byId("learners").replaceChildren(list);
    pressLearner(run);
    return;
  }
  byId("learners").replaceChildren(
    ...learners.map((robot) => {
      const dot = element("canvas", { class: "dot", width: 10, height: 10, "aria-hidden": "true" });
      const context = dot.getContext("2d");
      context.fillStyle = robotColour(run.number(robot.id));
      context.strokeStyle = "#ffffff";
      context.arc(5, 5, 4.5, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      const button = element("button", { type: "button", "data-robot": robot.id, onclick: () => choose(robot.id) }, dot, robot.id);
      return button;
    }),
  );
  pressLearner(run);
}

export function pressLearner(run) {
  for (const choice of byId("learners").children) {
    if (choice.matches("select")) choice.value = run.state.selected;
    else choice.setAttribute("aria-pressed", String(choice.dataset.robot === run.state.selected));
  }
}

/** A button for each visit of the chosen robot, to its beginning. */
export function drawVisits(run, seek) {
  const visits = (run.visits.get(run.state.selected) ?? []).filter(([, , phase]) => phase === "watching");
  byId("visits").replaceChildren(
    ...(visits.length ? [element("span", { class: "quiet" }, "visits")] : []),
    ...visits.map(([tS, number]) => element("button", { type: "button", title: `Visit ${number}, at ${clock(tS)}`, "aria-label": `Visit ${number}`, onclick: () => seek(tS + 2) }, number)),
  );
}

export function drawPlan(run) {
  const { about, frame } = run;
  say("run-name", about.trials > 1 ? `${about.name}, trial ${about.trial + 1} of ${about.trials}` : about.name);
  if (!frame) return;
  const learners = about.robots.filter((robot) => robot.role === "learner");
  const made = Math.min(...learners.map((robot) => frame.robots[robot.id].moves));
  say("plan-moves", `${made.toLocaleString("en")} of ${about.moves.toLocaleString("en")} moves`);
  say("plan-left", frame.phase === "ended" ? "the trial is over" : frame.left_s === null ? "" : `about ${inWords(frame.left_s)} left`);
  byId("plan-progress").value = made / about.moves;
  say("phase", frame.phase || "waiting");
  byId("phase").dataset.phase = frame.phase;
  say("clock", `${clock(frame.t_s)} / ${clock(run.state.end_s ?? 0)}`);
}

export function drawHealth(run) {
  const rows = byId("health");
  const robots = run.about.robots;
  while (rows.children.length > robots.length) rows.lastChild.remove();
  robots.forEach((robot, number) => {
    const row = rows.children[number] ?? rows.appendChild(element("tr", {}, ...Array.from({ length: 9 }, () => element("td"))));
    healthOf(run, robot).forEach(([text, level], column) => {
      const cell = row.children[column];
      if (cell.textContent !== text) cell.textContent = text;
      if (cell.dataset.level !== level) cell.dataset.level = level;
    });
  });
}

/** The cells of a robot's row, each with a level: "", "warning" or "error". */
function healthOf(run, robot) {
  const now = run.frame.robots[robot.id];
  const age = now.pose_age_s;
  const late = age === null || age > STALE_S;
  const slow = now.rate_hz < 0.7 * run.about.pose_rate_hz;
  const battery = now.battery_v;
  return [
    [robot.id, ""],
    [now.visit ? `${now.visit.phase === "ready" ? "goes to watch" : "watches"} ${now.visit.whom}` : now.activity || "-", ""],
    [now.moves.toLocaleString("en"), ""],
    [now.best === null ? "-" : String(now.best), ""],
    [age === null ? "none" : `${late ? "! " : ""}${age.toFixed(1)} s`, late ? "error" : ""],
    [`${slow ? "! " : ""}${now.rate_hz.toFixed(1)}`, slow ? "warning" : ""],
    [battery === null ? "-" : `${battery < LOW_BATTERY_V ? "! " : ""}${battery.toFixed(2)} V`, battery !== null && battery < LOW_BATTERY_V ? "error" : ""],
    [String(now.lost), now.lost ? "warning" : ""],
    [String(now.bad), now.bad ? "warning" : ""],
  ];
}

/** The events up to the moment that is shown, the newest first, drawn when there are others. */
export class Events {
  constructor(seek) {
    this.seek = seek;
    this.drawn = -1;
  }

  draw(run) {
    const tS = run.frame?.t_s ?? 0;
    const count = countUntil(run.events, tS);
    if (count === this.drawn) return;
    this.drawn = count;
    say("events-count", count ? `${count} so far` : "none so far");
    const shown = run.events.slice(Math.max(0, count - MOST_EVENTS), count).reverse();
    byId("events").replaceChildren(...shown.map((event) => this.#entry(run, event)));
  }

  #entry(run, [tS, level, who, name, text]) {
    const cure = level === "info" ? undefined : run.about.cures[name];
    return element(
      "li",
      {},
      element("button", { type: "button", title: "Go there", onclick: () => this.seek(tS) }, clock(tS)),
      element("span", { class: "level", "data-level": level }, { info: "info", warning: "! warning", error: "!! error" }[level] ?? level),
      element("span", { class: "text" }, `${who}: ${text}`),
      cure ? element("span", { class: "cure" }, cure) : null,
    );
  }
}

function countUntil(events, tS) {
  let [low, high] = [0, events.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (events[middle][0] <= tS + 0.05) low = middle + 1;
    else high = middle;
  }
  return low;
}
