// Elements of the page. Texts become text, whatever they hold: nothing is ever read as HTML.

const SVG = "http://www.w3.org/2000/svg";

function element(name, attributes, ...children) {
  return filled(document.createElement(name), attributes, children);
}

function drawn(name, attributes, ...children) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

// A number as a button: pressed, it says where it comes from.
function number(cell, data) {
  const button = element("button", { type: "button", class: "number" }, cell.text);
  button.addEventListener("click", () => showSource(cell.text, data.sources[cell.source], data.logs));
  return button;
}

function showSource(text, source, logs) {
  const panel = document.getElementById("source");
  const close = element("button", { type: "button", class: "close", "aria-label": "close" }, "×");
  close.addEventListener("click", () => { panel.hidden = true; });
  const lines = [["log", source.logs.map((place) => logNamed(logs[place])).join(", ")]];
  lines.push(["key", source.keys.join(", ")]);
  if (source.moves) {
    const [first, last] = source.moves;
    lines.push([first === last ? "move" : "moves", first === last ? counted(last) : `${counted(first)} to ${counted(last)}`]);
  }
  panel.replaceChildren(close, element("strong", {}, text), ` ${source.how}`, listed(lines));
  panel.hidden = false;
}

function logNamed(log) {
  return `${log.name} (SHA-256 ${log.sha256.slice(0, 12)}…)`;
}

function listed(lines) {
  const list = element("dl", {});
  for (const [name, text] of lines) {
    list.append(element("dt", {}, name), element("dd", {}, text));
  }
  return list;
}

function counted(value) {
  return value.toLocaleString("en");
}

// Round numbers at about `count` places of an axis from 0 to `end`.
function ticks(end, count) {
  const rough = end / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((size) => size >= 0.9 * rough);
  const found = [];
  for (let value = 0; value <= end * 1.0001; value += step) {
    found.push(value);
  }
  return found;
}
