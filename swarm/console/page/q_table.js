// A robot's Q-table: the best value of each cell as heat, its best moves as arrows, all eight on request.

import { arrow, prepared } from "./canvas.js";
import { between, colours } from "./colours.js";
import { COLUMNS, COMPASS, ROWS } from "./run.js";

const MOVES = 8;
const LARGEST = 0.7; // the goal's reward of 1, discounted over a move of 2.4 s (eq. 7)
const GAMMA = 0.45; // a cell far from the goal has a value of some hundredths: it is to be seen, too

const best = (table, state) => Math.max(...table.slice(state * MOVES, state * MOVES + MOVES));
const share = (value) => Math.min(1, Math.max(0, value / LARGEST)) ** GAMMA;

/** The tint of every cell that has a value. */
export function drawBest(context, table, columns, left, top, cell, strength) {
  const theme = colours();
  for (let state = 0; state < table.length / MOVES; state++) {
    const value = best(table, state);
    if (value <= 0) continue;
    context.fillStyle = between(theme["heat-low"], theme["heat-high"], strength * share(value));
    context.fillRect(left + (state % columns) * cell + 0.5, top + Math.floor(state / columns) * cell + 0.5, cell - 1, cell - 1);
  }
}

export class QTable {
  constructor(canvas, words) {
    this.canvas = canvas;
    this.words = words;
    this.chosen = null;
    this.run = null;
    canvas.addEventListener("pointermove", (event) => this.#choose(this.#stateAt(event)));
    canvas.addEventListener("pointerleave", () => this.#choose(null));
    canvas.addEventListener("keydown", (event) => this.#step(event));
  }

  draw(run) {
    this.run = run;
    const { context, width, height } = prepared(this.canvas);
    if (!run.about || width === 0) return;
    const { columns, rows } = run.about.arena;
    this.cell = Math.min((width - 2) / columns, (height - 2) / rows);
    this.left = (width - columns * this.cell) / 2;
    this.top = 1;
    this.#drawGrid(context, columns, rows);
    if (run.learner) {
      drawBest(context, run.learner.q_table, columns, this.left, this.top, this.cell, 1);
      this.#drawArrows(context, run.learner.q_table, columns);
    }
    this.#drawRobot(context, run, columns);
    this.#drawChosen(context, columns);
    this.#say();
  }

  #drawGrid(context, columns, rows) {
    const theme = colours();
    context.fillStyle = theme.cell;
    context.fillRect(this.left, this.top, columns * this.cell, rows * this.cell);
    context.strokeStyle = theme["cell-line"];
    context.lineWidth = 1;
    for (let state = 0; state < columns * rows; state++) context.strokeRect(...this.#box(state, columns), this.cell, this.cell);
    context.strokeStyle = theme.wall;
    context.lineWidth = 2;
    context.strokeRect(this.left, this.top, columns * this.cell, rows * this.cell);
  }

  #box = (state, columns) => [this.left + (state % columns) * this.cell, this.top + Math.floor(state / columns) * this.cell];

  #drawArrows(context, table, columns) {
    const theme = colours();
    for (let state = 0; state < table.length / MOVES; state++) {
      const value = best(table, state);
      if (value <= 0) continue;
      const [x, y] = this.#box(state, columns).map((at) => at + this.cell / 2);
      context.strokeStyle = context.fillStyle = share(value) > 0.55 ? theme.panel : theme.ink;
      context.lineWidth = Math.max(1.2, this.cell / 22);
      for (let move = 0; move < MOVES; move++) {
        if (table[state * MOVES + move] < value) continue;
        const length = (0.36 * this.cell) / Math.hypot(COLUMNS[move], ROWS[move]);
        const [dx, dy] = [COLUMNS[move] * length, ROWS[move] * length];
        arrow(context, [x - dx, y - dy], [x + dx, y + dy], this.cell * 0.26);
      }
    }
  }

  #drawRobot(context, run, columns) {
    const cell = run.frame?.robots[run.state.selected]?.cell;
    if (cell === null || cell === undefined) return;
    context.strokeStyle = colours().warn;
    context.lineWidth = 2.5;
    const [x, y] = this.#box(cell, columns);
    context.strokeRect(x + 2, y + 2, this.cell - 4, this.cell - 4);
  }

  #drawChosen(context, columns) {
    if (this.chosen === null) return;
    context.strokeStyle = colours().ink;
    context.lineWidth = 2;
    context.strokeRect(...this.#box(this.chosen, columns), this.cell, this.cell);
  }

  #say() {
    const table = this.run.learner?.q_table;
    const text =
      this.chosen === null || !table
        ? `Best value of each cell; arrows are the best moves. Point at a cell for all eight values.${this.#unheard()}`
        : `Cell ${this.chosen}: ${COMPASS.map((name, move) => `${name} ${table[this.chosen * MOVES + move].toFixed(3)}`).join("  ")}`;
    if (this.words.textContent !== text) this.words.textContent = text;
  }

  /** A console that joined a run late does not know what was learnt before. */
  #unheard() {
    const first = this.run.learner?.first ?? 0;
    return first > 1 ? ` What was learnt before move ${first} was not heard.` : "";
  }

  #stateAt(event) {
    if (!this.run?.about || !this.cell) return null;
    const { columns, rows } = this.run.about.arena;
    const [column, row] = [Math.floor((event.offsetX - this.left) / this.cell), Math.floor((event.offsetY - this.top) / this.cell)];
    return column >= 0 && row >= 0 && column < columns && row < rows ? row * columns + column : null;
  }

  #choose(state) {
    if (state === this.chosen || !this.run) return;
    this.chosen = state;
    this.draw(this.run);
  }

  /** Arrow keys go from cell to cell while the table has the focus. */
  #step(event) {
    const step = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] }[event.key];
    if (!step || !this.run?.about) return;
    event.preventDefault();
    event.stopPropagation();
    const { columns, rows } = this.run.about.arena;
    const state = this.chosen ?? 0;
    const column = Math.min(columns - 1, Math.max(0, (state % columns) + step[0]));
    const row = Math.min(rows - 1, Math.max(0, Math.floor(state / columns) + step[1]));
    this.#choose(row * columns + column);
  }
}
