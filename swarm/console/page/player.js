// The bar at the bottom: play, pace, time, and the keys that do the same.

import { colours, robotColour } from "./colours.js";
import { prepared } from "./canvas.js";
import { byId, say } from "./dom.js";
import { clock } from "./run.js";

const SPEEDS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const MINUTE_S = 60;

export class Player {
  constructor(run, ask) {
    this.run = run;
    this.ask = ask;
    this.dragging = false;
    const speed = byId("speed");
    for (const times of SPEEDS) speed.append(new Option(`${times} x`, String(times)));
    speed.addEventListener("change", () => ask({ ask: "speed", times: Number(speed.value) }));
    byId("play").addEventListener("click", () => this.toggle());
    byId("previous").addEventListener("click", () => this.step(-1));
    byId("next").addEventListener("click", () => this.step(1));
    byId("live").addEventListener("click", () => ask({ ask: "live" }));
    byId("scrub").addEventListener("input", () => this.#scrub());
    byId("scrub").addEventListener("change", () => (this.dragging = false));
    byId("go-to-move").addEventListener("submit", (event) => {
      event.preventDefault();
      this.#goTo(Number(byId("move").value));
    });
    document.addEventListener("keydown", (event) => this.#key(event));
  }

  toggle() {
    this.ask({ ask: this.run.state.playing ? "pause" : "play" });
  }

  /** So many moves of the chosen robot back or on. */
  step(count) {
    this.#goTo((this.run.frame?.robots[this.run.state.selected]?.moves ?? 0) + count);
  }

  seek(tS) {
    this.ask({ ask: "pause" });
    this.ask({ ask: "seek", t_s: Math.max(0, tS) });
  }

  /** The state of the run's playing, on the bar. */
  draw() {
    const { state, frame } = this.run;
    const end = state.end_s || 1;
    byId("play").textContent = state.playing ? "\u23F8" : "\u25B6";
    byId("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
    byId("live").hidden = !state.is_live;
    byId("live").setAttribute("aria-pressed", String(Boolean(state.live)));
    const nearest = SPEEDS.reduce((a, b) => (Math.abs(b - state.speed) < Math.abs(a - state.speed) ? b : a));
    byId("speed").disabled = Boolean(state.live);
    if (document.activeElement !== byId("speed")) byId("speed").value = String(nearest);
    say("go-to-words", `move of ${state.selected ?? "it"}`);
    const scrub = byId("scrub");
    if (Number(scrub.max) !== end) scrub.max = String(end);
    if (!this.dragging && frame) scrub.value = String(frame.t_s);
    if (frame) scrub.setAttribute("aria-valuetext", clock(frame.t_s));
  }

  /** The visits of every robot as ticks above the time. */
  drawTicks() {
    const { context, width, height } = prepared(byId("ticks"));
    const end = this.run.state.end_s || 1;
    for (const [id, visits] of this.run.visits) {
      context.fillStyle = robotColour(this.run.number(id));
      for (const [tS, , phase] of visits) if (phase === "watching") context.fillRect(8 + (tS / end) * (width - 16) - 1.5, 2, 3, height - 2);
    }
    context.fillStyle = colours().bad;
    for (const [tS, level] of this.run.events) if (level === "error") context.fillRect(8 + (tS / end) * (width - 16) - 1, 5, 2, height - 5);
  }

  #scrub() {
    this.dragging = true;
    this.ask({ ask: "seek", t_s: Number(byId("scrub").value) });
  }

  #goTo(number) {
    this.ask({ ask: "pause" });
    this.ask({ ask: "move", robot: this.run.state.selected, number: Math.max(1, Math.round(number) || 1) });
  }

  #pace(step) {
    const place = SPEEDS.indexOf(Number(byId("speed").value)) + step;
    this.ask({ ask: "speed", times: SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, place))] });
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    if (event.target.matches("input, select, textarea") || (event.key === " " && event.target.matches("button"))) return;
    const frame = this.run.frame;
    const act = {
      " ": () => this.toggle(),
      ArrowLeft: () => (event.shiftKey ? this.seek(frame.t_s - MINUTE_S) : this.step(-1)),
      ArrowRight: () => (event.shiftKey ? this.seek(frame.t_s + MINUTE_S) : this.step(1)),
      Home: () => this.seek(0),
      End: () => this.seek(this.run.state.end_s),
      "-": () => this.#pace(-1),
      "+": () => this.#pace(1),
      "=": () => this.#pace(1),
      l: () => this.run.state.is_live && this.ask({ ask: "live" }),
      "?": () => byId("help").showModal(),
    }[event.key];
    const learner = byId("learners").querySelectorAll("button")[Number(event.key) - 1];
    if (!frame || !(act || learner)) return;
    event.preventDefault();
    act ? act() : learner.click();
  }
}
