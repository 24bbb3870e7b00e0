// The controls of a live run: orders of whoever may steer, and what a hand is wanted for.

import { byId, element } from "./dom.js";

const SURE_MS = 4000; // a second press within this time gives an order that cannot be taken back
const ANSWER_MS = 8000; // an answer is shown so long

export class Steering {
  constructor(run, ask) {
    this.run = run;
    this.ask = ask;
    this.place = byId("steering");
    this.answer = element("span", { role: "status", class: "answer" });
    this.prompts = element("div", { class: "prompts" });
    this.orders = element("div", { class: "orders" });
    this.place.append(this.orders, this.answer, this.prompts);
    this.drawn = "";
    document.addEventListener("keydown", (event) => {
      if (event.key === "X" && event.shiftKey && this.run.state.may_steer) this.give("estop");
    });
  }

  give(order, prompt = 0) {
    const robot = order === "pause" || order === "resume" ? (byId("order-robot")?.value ?? "") : "";
    this.ask({ ask: "order", order, robots: robot ? [robot] : [], prompt });
    this.say("...", true);
  }

  /** What became of an order. */
  hear({ accepted, text }) {
    this.say(accepted ? text : `refused: ${text}`, accepted);
  }

  say(text, isGood) {
    this.answer.textContent = text;
    this.answer.dataset.good = String(isGood);
    clearTimeout(this.forget);
    this.forget = setTimeout(() => (this.answer.textContent = ""), ANSWER_MS);
  }

  draw() {
    const { controls, may_steer: maySteer } = this.run.state;
    const drawn = JSON.stringify([controls, maySteer]);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    this.place.hidden = !controls;
    if (!controls) return;
    if (maySteer) this.#drawOrders(controls);
    this.prompts.replaceChildren(
      ...controls.missing.map((who) => element("p", { class: "prompt" }, `waiting for ${who}`)),
      ...controls.prompts.map((prompt) => this.#prompt(prompt, maySteer)),
    );
  }

  #drawOrders({ phase, paused }) {
    const chosen = byId("order-robot")?.value ?? "";
    const robots = element("select", { id: "order-robot", "aria-label": "Whom pause and resume are for" },
      element("option", { value: "" }, "all robots"),
      ...this.run.about.robots.map((robot) => element("option", { value: robot.id }, paused.includes(robot.id) ? `${robot.id} (paused)` : robot.id)));
    robots.value = chosen;
    const isStopped = phase === "estopped";
    this.orders.replaceChildren(
      robots,
      element("button", { type: "button", onclick: () => this.give("pause") }, "pause"),
      element("button", { type: "button", onclick: () => this.give("resume"), disabled: isStopped }, "resume"),
      this.#sure("stop", "stop", "end the trial?"),
      isStopped
        ? this.#sure("release", "release", "everybody clear?")
        : element("button", { type: "button", class: "estop", title: "Stop every wheel at once (shift X)", onclick: () => this.give("estop") }, "EMERGENCY STOP"),
    );
  }

  /** A button that wants to be pressed twice. */
  #sure(order, words, question) {
    let until = 0;
    const button = element("button", { type: "button", class: "stop", onclick: () => {
      if (performance.now() < until) {
        this.give(order);
        return;
      }
      until = performance.now() + SURE_MS;
      button.textContent = question;
      setTimeout(() => (button.textContent = words), SURE_MS);
    } }, words);
    return button;
  }

  #prompt({ number, text }, maySteer) {
    const done = maySteer ? element("button", { type: "button", onclick: () => this.give("done", number) }, "done") : null;
    return element("p", { class: "prompt" }, `${number}: ${text}`, done);
  }
}
