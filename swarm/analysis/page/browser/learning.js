// One robot's learning at any of its moves: what it knows, where it is, and what it remembers.

const SNAPSHOT_EVERY = 500; // moves: a table is at most so many updates from the nearest one kept

function knowledgeOf(learning) {
  const size = learning.columns * learning.rows * ACTIONS.length;
  const kept = [new Float64Array(size)];
  const table = new Float64Array(size);
  learning.state.forEach((state, place) => {
    learnt(table, learning, place);
    if ((place + 1) % SNAPSHOT_EVERY === 0) {
      kept.push(table.slice());
    }
  });
  // The table (state, action) after so many of the recorded moves.
  return (count) => {
    const nearest = Math.floor(count / SNAPSHOT_EVERY);
    const found = kept[nearest].slice();
    for (let place = nearest * SNAPSHOT_EVERY; place < count; place += 1) {
      learnt(found, learning, place);
    }
    return found;
  };
}

function learnt(table, learning, place) {
  if (learning.action[place] !== null) {
    table[learning.state[place] * ACTIONS.length + learning.action[place]] = learning.q_value[place];
  }
}

// From pale to dark blue by the best value of a cell, as a share of the highest.
function heat(share) {
  return `hsl(213 ${30 + 50 * share}% ${97 - 52 * share}%)`;
}

function mapDrawn(learning, table, count) {
  const { columns, rows } = learning;
  const svg = drawn("svg", { viewBox: `-0.1 -0.1 ${columns + 0.2} ${rows + 0.2}`, class: "map", role: "img", "aria-label": "Q: the best moves of each cell" });
  const best = [];
  for (let state = 0; state < columns * rows; state += 1) {
    best.push(Math.max(...table.subarray(state * ACTIONS.length, (state + 1) * ACTIONS.length)));
  }
  const highest = Math.max(...best, 1e-9);
  best.forEach((value, state) => {
    const [x, y] = [state % columns, Math.floor(state / columns)];
    svg.append(drawn("rect", { x, y, width: 1, height: 1, fill: value > 0 ? heat(value / highest) : "#f6f6f4", class: "cell" }));
    if (value > 0 && state !== learning.goal) {
      bestActions(table, state, value).forEach((action) => svg.append(arrow(x + 0.5, y + 0.5, STEPS[ACTIONS[action]], value / highest)));
    }
  });
  for (const [name, state] of [["S", learning.start], ["G", learning.goal]]) {
    svg.append(drawn("text", { class: "place", x: (state % columns) + 0.1, y: Math.floor(state / columns) + 0.36 }, name));
  }
  svg.append(trail(learning, count));
  return svg;
}

function bestActions(table, state, value) {
  return ACTIONS.map((_, action) => action).filter((action) => table[state * ACTIONS.length + action] === value);
}

function arrow(x, y, [east, south], share) {
  const length = Math.hypot(east, south);
  const [dx, dy] = [(0.3 * east) / length, (0.3 * south) / length];
  const tip = `M${x + dx} ${y + dy}l${-0.6 * dx - 0.35 * dy} ${-0.6 * dy + 0.35 * dx}l${0.7 * dy} ${-0.7 * dx}Z`;
  return drawn("path", { class: share > 0.55 ? "arrow light" : "arrow", d: `M${x - dx} ${y - dy}L${x + dx} ${y + dy}${tip}` });
}

// The journey that is under way, and the robot at its end.
function trail(learning, count) {
  const group = drawn("g", {});
  const centre = (state) => [(state % learning.columns) + 0.5, Math.floor(state / learning.columns) + 0.5];
  const cells = [];
  for (let place = count - 1; place >= 0 && learning.track[place] === learning.track[count - 1]; place -= 1) {
    if (!cells.length) {
      cells.push(learning.next_state[place]);
    }
    cells.push(learning.state[place]);
  }
  if (cells.length > 1) {
    group.append(drawn("path", { class: "trail", d: strokes(cells.reverse().map(centre)) }));
  }
  const [x, y] = centre(count ? learning.next_state[count - 1] : learning.start);
  group.append(drawn("circle", { class: "robot", cx: x, cy: y, r: 0.24 }));
  return group;
}

// What the memory holds after so many moves: each path with its R and how often it was replayed.
function memoryAt(learning, count) {
  const made = count ? learning.number[count - 1] : 0;
  const ratios = new Map();
  const replays = new Map();
  learning.replays.after.forEach((after, place) => {
    if (after <= made) {
      const path = learning.replays.path[place];
      ratios.set(path, learning.replays.ratio[place]);
      replays.set(path, (replays.get(path) || 0) + 1);
    }
  });
  return learning.remembered
    .filter((each) => each.after <= made)
    .map((each) => ({ ...each, ratio: ratios.has(each.path) ? ratios.get(each.path) : 1, replays: replays.get(each.path) || 0 }));
}

function memoryTable(learning, count) {
  const replayed = count ? learning.path[count - 1] : 0;
  const found = memoryAt(learning, count);
  if (!found.length) {
    return element("p", { class: "quiet" }, "No path is remembered yet.");
  }
  const body = element("tbody", {});
  for (const each of found) {
    body.append(element("tr", each.path === replayed ? { class: "replayed" } : {},
      element("td", {}, String(each.path)), element("td", {}, pathDrawn(each.moves, [], 40)),
      element("td", { class: "count" }, element("meter", { min: 0, max: 1, value: Math.min(1, each.ratio), "aria-label": "R" }), ` ${each.ratio.toFixed(2)}`),
      element("td", { class: "count" }, counted(each.replays)),
      element("td", { class: "count" }, each.visit ? `visit ${each.visit}` : each.from), element("td", { class: "count" }, counted(each.after))));
  }
  const head = element("tr", {}, ...["path", "", "R", "replays", "from", "since move"].map((name) => element("th", { scope: "col" }, name)));
  return element("table", {}, element("thead", {}, head), body);
}

function moveInWords(learning, count) {
  if (!count) {
    return "Before the first move: nothing is known.";
  }
  const place = count - 1;
  const cell = (state) => `(${state % learning.columns}, ${Math.floor(state / learning.columns)})`;
  const action = learning.action[place] === null ? "?" : ACTIONS[learning.action[place]];
  const stood = learning.state[place] === learning.next_state[place] ? ", into a wall" : "";
  const replay = learning.path[place] ? `, replaying path ${learning.path[place]}` : "";
  return `Move ${counted(learning.number[place])}, journey ${counted(learning.track[place])}, at ${counted(learning.t_s[place])} s: ` +
    `${action} from ${cell(learning.state[place])} to ${cell(learning.next_state[place])}${stood}; Q is ${learning.q_value[place]} now${replay}.`;
}
