// Puts the page together from its data.

const SMALL = { width: 880, height: 120, left: 56, right: 16, top: 8, bottom: 24 };
const PLAYED_IN_S = 20; // from the first move to the last at the speed of 1

function tableDrawn(table, data) {
  const head = element("tr", {}, ...table.head.map((name) => element("th", { scope: "col" }, name)));
  const body = element("tbody", {}, ...table.rows.map((row) => element("tr", {}, ...row.map((cell) => cellDrawn(cell, data)))));
  const note = table.note ? element("p", { class: "quiet" }, table.note) : null;
  const wide = element("div", { class: "wide", tabindex: "0", role: "region", "aria-label": table.title }, element("table", {}, element("thead", {}, head), body));
  return element("section", { id: table.name }, element("h2", {}, table.title), note, wide);
}

function cellDrawn(cell, data) {
  if (typeof cell === "string") {
    return element("td", {}, cell);
  }
  if (cell.moves) {
    return element("td", {}, pathDrawn(cell.moves, cell.real, 64));
  }
  const parts = (Array.isArray(cell) ? cell : [cell]).map((part) => (typeof part === "string" ? part : number(part, data)));
  return element("td", { class: "count" }, ...parts);
}

function learningSection(data) {
  const chooser = element("select", { id: "robot" });
  data.learning.forEach((each, place) => {
    chooser.append(element("option", { value: place }, `${each.robot} (${each.condition}), trial ${each.trial} of seed ${each.seed}`));
  });
  const view = element("div", {});
  const show = () => view.replaceChildren(...scrubber(data.learning[chooser.value], data));
  chooser.addEventListener("change", show);
  show();
  const label = element("label", { for: "robot" }, "Robot ");
  return element("section", { id: "one-robot" }, element("h2", {}, "One robot's learning"), element("p", {}, label, chooser), view);
}

function scrubber(learning, data) {
  const knowledge = knowledgeOf(learning);
  const last = learning.number.length;
  const slider = element("input", { type: "range", min: 0, max: last, value: last, "aria-label": "move" });
  const words = element("p", { class: "words" });
  const map = element("div", { class: "map-place" });
  const memory = element("div", { class: "memory" });
  const { figure, point } = bestChart(learning, data);
  const show = () => {
    const count = Number(slider.value);
    map.replaceChildren(mapDrawn(learning, knowledge(count), count));
    memory.replaceChildren(element("h3", {}, "Memory"), memoryTable(learning, count));
    words.replaceChildren(moveInWords(learning, count), " ", provenance(learning, count, data));
    point(count ? learning.number[count - 1] : 0);
  };
  slider.addEventListener("input", show);
  show();
  const bar = element("div", { class: "bar" }, ...buttons(slider, last, show), slider);
  const legend = element("p", { class: "quiet" }, "Darker: a higher best Q. Arrows: the best moves. Orange: the journey under way. S: start, G: goal.");
  return [bar, words, element("div", { class: "side-by-side" }, element("div", {}, map, legend), memory), figure];
}

function provenance(learning, count, data) {
  const button = element("button", { type: "button", class: "number" }, "Where from?");
  const made = count ? learning.number[count - 1] : 0;
  button.addEventListener("click", () => showSource(`Up to move ${counted(made)}:`, { ...data.sources[learning.source], moves: [Math.min(1, made), made] }, data.logs));
  return button;
}

function buttons(slider, last, show) {
  let playing = 0;
  const play = element("button", { type: "button" }, "Play");
  const speed = element("select", { "aria-label": "speed" }, ...[0.1, 0.25, 1, 4].map((value) => element("option", value === 1 ? { value, selected: "" } : { value }, `${value} ×`)));
  const to = (count) => {
    slider.value = Math.max(0, Math.min(last, count));
    show();
  };
  const stop = () => {
    cancelAnimationFrame(playing);
    playing = 0;
    play.textContent = "Play";
  };
  const start = () => {
    let [before, at] = [performance.now(), Number(slider.value) >= last ? 0 : Number(slider.value)];
    play.textContent = "Pause";
    const next = (now) => {
      at += ((now - before) / 1000 / PLAYED_IN_S) * last * Number(speed.value);
      before = now;
      to(Math.floor(at));
      playing = at >= last || !slider.isConnected ? stop() : requestAnimationFrame(next);
    };
    playing = requestAnimationFrame(next);
  };
  play.addEventListener("click", () => (playing ? stop() : start()));
  const step = (name, by) => {
    const button = element("button", { type: "button", "aria-label": by < 0 ? "one move back" : "one move on" }, name);
    button.addEventListener("click", () => { stop(); to(Number(slider.value) + by); });
    return button;
  };
  return [step("‹", -1), play, step("›", 1), speed];
}

// The robot's own curve, with a rule at the move that is shown.
function bestChart(learning, data) {
  const end = Math.max(1, learning.number[learning.number.length - 1] || 1);
  const axes = chartAxes(SMALL, end, data.cap * 1.04);
  const svg = drawn("svg", { viewBox: `0 0 ${SMALL.width} ${SMALL.height}`, class: "chart", role: "img", "aria-label": "its best path length against its moves" });
  svg.append(axesDrawn(axes, ["", "best path"]));
  svg.append(drawn("path", { class: "own", d: line(axes, learning.best.move, learning.best.length) }));
  const rule = drawn("line", { class: "rule", y1: SMALL.top, y2: SMALL.height - SMALL.bottom });
  svg.append(rule);
  const point = (move) => {
    rule.setAttribute("x1", axes.across(move));
    rule.setAttribute("x2", axes.across(move));
  };
  return { figure: element("figure", {}, svg), point };
}

function notesSection(data) {
  const items = data.notes.map((note) => element("li", {}, note));
  return data.notes.length ? element("section", {}, element("h2", {}, "Notes"), element("ul", {}, ...items)) : null;
}

function show(data) {
  const page = document.getElementById("page");
  const how = "A number that is underlined says where it comes from when it is pressed. ";
  const verify = [element("code", {}, "swarm verify"), " makes all of them once more from the logs."];
  page.append(element("h1", {}, data.title), element("p", {}, `${data.note} ${how}`, ...verify));
  page.append(curvesChart(data));
  const [first, ...others] = data.tables;
  page.append(tableDrawn(first, data));
  if (data.learning.length) {
    page.append(learningSection(data));
  }
  page.append(...others.map((table) => tableDrawn(table, data)));
  const notes = notesSection(data);
  if (notes) {
    page.append(notes);
  }
}

show(JSON.parse(document.getElementById("data").textContent));
