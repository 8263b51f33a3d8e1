// The blended maps: sliders choose a point of the lattice, a cube and three projections show its map and draws.
const CUBE = { width: 520, height: 480, size: 122, distance: 5 };

function startMaps() {
  const data = DATA.maps, view = document.getElementById("maps-view");
  if (!data || !view) { return; }
  const cells = data.parameters.map((axis) => axis.values.length);
  while (cells.length < 3) { cells.push(1); }
  const state = {
    at: data.dependencies.map((axis) => Math.floor((axis.values.length - 1) / 2)), model: 0, draws: true, yaw: -0.65, pitch: 0.42,
  };
  const maps = bytesOf(data.maps);
  const models = data.models.map((model) => ({ ...model, draws: bytesOf(model.draws) }));
  const modes = bytesOf(data.modes);

  function point() {
    return data.dependencies.reduce((index, axis, i) => index * axis.values.length + state.at[i], 0);
  }

  // What is drawn: density of each cell relative to the best one, draws and mode as shares of each parameter's range.
  function current() {
    const count = cells[0] * cells[1] * cells[2], model = models[state.model], used = data.parameters.length;
    const values = maps.subarray(point() * count, (point() + 1) * count);
    const best = Math.max(1, values.reduce((a, b) => Math.max(a, b), 0));
    const triples = (bytes, first, number) => Array.from({ length: number }, (_, i) =>
      [0, 1, 2].map((axis) => (axis < used ? bytes[(first + i) * used + axis] / 255 : 0.5)));
    return {
      shares: Float32Array.from(values, (value) => Math.pow(value / best, model.exponents[point()])),
      best: best / 255,
      draws: triples(model.draws, point() * data.draws, data.draws),
      mode: triples(modes, point(), 1)[0],
      model,
    };
  }

  function controls() {
    const place = document.getElementById("maps-controls");
    data.dependencies.forEach((axis, index) => {
      if (axis.values.length < 2) { return; }
      const text = (i) => axis.values[i].toFixed(2) + (axis.unit && axis.unit !== "1" ? " " + axis.unit : "");
      place.append(slider(symbolOf(axis.name), axis.values.length, state.at[index], text, (i) => { state.at[index] = i; draw(); }));
    });
    const names = models.map((model) => model.name);
    place.append(chooser("Model", names, (i) => { state.model = i; draw(); }).field);
    const degrees = (value) => Math.round(value * 180 / Math.PI) + "°";
    const turns = Array.from({ length: 73 }, (_, i) => -Math.PI + i * Math.PI / 36);
    const nearest = turns.reduce((a, b, i) => (Math.abs(b - state.yaw) < Math.abs(turns[a] - state.yaw) ? i : a), 0);
    place.append(slider("turn the cube", turns.length, nearest, (i) => degrees(turns[i]), (i) => { state.yaw = turns[i]; draw(); }));
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => { state.draws = box.checked; draw(); });
    place.append(element("label", { class: "row" }, element("span", { class: "row" }, box, " draws")));
  }

  function draw() {
    const now = current();
    drawCube(document.getElementById("maps-cube"), data, cells, now, state);
    drawProjections(document.getElementById("maps-slices"), data, cells, now, state);
    const mode = data.parameters.map((axis, i) => {
      const low = axis.values[0], high = axis.values[axis.values.length - 1];
      return symbolOf(axis.name) + " " + (low + now.mode[i] * (high - low)).toFixed(2) + " " + axis.unit;
    });
    const outside = data.inside[point()] === "1" ? "" : " Outside the range of the training walks: the nearest that are known answer.";
    document.getElementById("maps-readout").textContent =
      "Highest point: " + mode.join(", ") + "; suitability of the best cell " + now.best.toFixed(2) +
      "; exponent " + now.model.exponents[point()] + "." + outside;
  }

  function dragging(canvas) {
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      let x = event.clientX, y = event.clientY;
      const move = (next) => {
        state.yaw += (next.clientX - x) / 150;
        state.pitch = Math.min(1.4, Math.max(-0.2, state.pitch + (next.clientY - y) / 150));
        x = next.clientX; y = next.clientY;
        draw();
      };
      canvas.addEventListener("pointermove", move);
      canvas.addEventListener("pointerup", () => canvas.removeEventListener("pointermove", move), { once: true });
      canvas.addEventListener("pointercancel", () => canvas.removeEventListener("pointermove", move), { once: true });
    });
  }

  controls();
  dragging(document.getElementById("maps-cube"));
  draw();
  new ResizeObserver(draw).observe(document.getElementById("maps-cube"));
}

// A point of the unit cube in the picture: x and y in pixels, and how near it is.
function projected(share, state) {
  const [x, y, z] = share.map((value) => 2 * value - 1);
  const cos = Math.cos(state.yaw), sin = Math.sin(state.yaw), up = Math.cos(state.pitch), over = Math.sin(state.pitch);
  const across = x * cos - y * sin, deep = x * sin + y * cos;
  const near = deep * up - z * over, high = deep * over + z * up;
  const zoom = CUBE.distance / (CUBE.distance + near);
  return { x: CUBE.width / 2 + 18 + across * CUBE.size * zoom, y: CUBE.height / 2 - 6 - high * CUBE.size * zoom, near, zoom };
}

function drawCube(canvas, data, cells, now, state) {
  const pen = context(canvas, CUBE.width, CUBE.height);
  drawFrame(pen, data, state);
  const marks = [];
  const share = (index, count) => (count > 1 ? index / (count - 1) : 0.5);
  for (let i = 0, cell = 0; i < cells[0]; i += 1) {
    for (let j = 0; j < cells[1]; j += 1) {
      for (let k = 0; k < cells[2]; k += 1, cell += 1) {
        const at = projected([share(i, cells[0]), share(j, cells[1]), share(k, cells[2])], state);
        marks.push({ ...at, value: now.shares[cell] });
      }
    }
  }
  if (state.draws) { for (const draw of now.draws) { marks.push({ ...projected(draw, state), ring: true }); } }
  marks.sort((a, b) => b.near - a.near);
  const largest = 0.75 * CUBE.size / Math.max(...cells);
  for (const mark of marks) {
    pen.beginPath();
    if (mark.ring) {
      ring(pen, mark.x, mark.y, now.model.name);
    } else {
      pen.globalAlpha = 0.15 + 0.7 * mark.value;
      pen.fillStyle = viridis(mark.value);
      pen.arc(mark.x, mark.y, mark.zoom * (0.8 + largest * mark.value), 0, 2 * Math.PI);
      pen.fill();
    }
    pen.globalAlpha = 1;
  }
}

function ring(pen, x, y, model) {
  pen.beginPath();
  pen.arc(x, y, 3.6 * pen.unit, 0, 2 * Math.PI);
  pen.fillStyle = "#ffffff";
  pen.fill();
  pen.lineWidth = 2 * pen.unit;
  pen.strokeStyle = colourOf(model);
  pen.stroke();
}

// The floor of the cube and one upright edge, with names and ends of the parameters.
function drawFrame(pen, data, state) {
  const line = (from, to) => {
    const a = projected(from, state), b = projected(to, state);
    pen.beginPath(); pen.moveTo(a.x, a.y); pen.lineTo(b.x, b.y); pen.stroke();
  };
  pen.strokeStyle = FAINT;
  pen.lineWidth = 1;
  const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
  corners.forEach(([x, y], i) => {
    const [nextX, nextY] = corners[(i + 1) % 4];
    line([x, y, 0], [nextX, nextY, 0]);
    line([x, y, 1], [nextX, nextY, 1]);
    line([x, y, 0], [x, y, 1]);
  });
  // Labels stand at the edges of the floor that are nearest to the viewer, so that the cube never hides them.
  const side = (axis) => [0, 1].reduce((best, value) => {
    const middle = axis === 0 ? [0.5, value, 0] : [value, 0.5, 0];
    const at = projected(middle, state);
    return best === null || at.y > best.at.y ? { value, at } : best;
  }, null).value;
  const y = side(0), x = side(1);
  const out = (value) => (value === 1 ? 1.22 : -0.22);
  pen.fillStyle = INK;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  const label = (text, at) => {
    const p = projected(at, state), half = pen.measureText(text).width / 2 + 3;
    pen.fillText(text, Math.min(Math.max(p.x, half), CUBE.width - half), p.y);
  };
  const axes = [
    { name: (s) => [s, out(y), 0], ends: (s) => [s, y === 1 ? 1.1 : -0.1, 0] },
    { name: (s) => [out(x), s, 0], ends: (s) => [x === 1 ? 1.1 : -0.1, s, 0] },
    { name: (s) => upright(state, 0.22, s), ends: (s) => upright(state, 0.1, s) },
  ];
  data.parameters.forEach((axis, i) => {
    pen.fillStyle = INK;
    label(withUnit(axis.name, axis.unit), axes[i].name(0.5));
    pen.fillStyle = SOFT;
    label(axis.values[0].toFixed(1), axes[i].ends(0.02));
    label(axis.values[axis.values.length - 1].toFixed(1), axes[i].ends(0.98));
  });
}

// A point beside the leftmost upright edge.
function upright(state, distance, s) {
  const corner = [[0, 0], [1, 0], [1, 1], [0, 1]].reduce((best, xy) => {
    const at = projected([...xy, 0], state).x;
    return best === null || at < best.at ? { xy, at } : best;
  }, null).xy;
  return [corner[0] + (corner[0] - 0.5) * distance * 2, corner[1] + (corner[1] - 0.5) * distance * 2, s];
}

// Best over the third parameter, for each pair of parameters.
function drawProjections(canvas, data, cells, now, state) {
  const pen = context(canvas, CUBE.width, CUBE.height);
  const pairs = [[0, 1], [0, 2], [1, 2]].filter(([, second]) => second < data.parameters.length);
  const side = 150, lefts = [76, 340, 76], tops = [14, 14, 254];
  pairs.forEach(([first, second], place) => {
    const best = new Float32Array(cells[first] * cells[second]);
    for (let i = 0, cell = 0; i < cells[0]; i += 1) {
      for (let j = 0; j < cells[1]; j += 1) {
        for (let k = 0; k < cells[2]; k += 1, cell += 1) {
          const at = [i, j, k], flat = at[first] * cells[second] + at[second];
          best[flat] = Math.max(best[flat], now.shares[cell]);
        }
      }
    }
    drawProjection(pen, data, cells, best, first, second, lefts[place], tops[place], side);
    if (!state.draws) { return; }
    const inset = (share, count) => (share * (count - 1) + 0.5) / count * side;  // values stand at the centres of cells
    for (const draw of now.draws) {
      ring(pen, lefts[place] + inset(draw[first], cells[first]), tops[place] + side - inset(draw[second], cells[second]), now.model.name);
    }
  });
  drawScale(pen, 284, 290, now);
}

function drawProjection(pen, data, cells, best, first, second, left, top, side) {
  const wide = side / cells[first], high = side / cells[second];
  for (let i = 0; i < cells[first]; i += 1) {
    for (let j = 0; j < cells[second]; j += 1) {
      pen.fillStyle = viridis(best[i * cells[second] + j]);
      pen.fillRect(left + i * wide, top + side - (j + 1) * high, wide + 0.5, high + 0.5);
    }
  }
  const ends = (axis) => [data.parameters[axis].values[0], data.parameters[axis].values[cells[axis] - 1]];
  pen.fillStyle = SOFT;
  pen.textBaseline = "middle";
  pen.textAlign = "center";
  ends(first).forEach((value, i) => pen.fillText(value.toFixed(1), left + wide / 2 + i * (side - wide), top + side + 11 * pen.unit));
  pen.textAlign = "right";
  ends(second).forEach((value, i) => pen.fillText(value.toFixed(1), left - 6, top + side - high / 2 - i * (side - high)));
  pen.fillStyle = INK;
  pen.textAlign = "center";
  pen.fillText(withUnit(data.parameters[first].name, data.parameters[first].unit), left + side / 2, top + side + 25 * pen.unit);
  pen.save();
  pen.translate(left - 6 - 33 * pen.unit, top + side / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText(withUnit(data.parameters[second].name, data.parameters[second].unit), 0, 0);
  pen.restore();
}

function drawScale(pen, left, top, now) {
  for (let i = 0; i < 100; i += 1) {
    pen.fillStyle = viridis(i / 99);
    pen.fillRect(left + i * 1.3, top, 1.8, 10);
  }
  pen.textAlign = "left";
  pen.fillStyle = SOFT;
  pen.fillText("0", left, top + 13 + 10 * pen.unit);
  pen.textAlign = "right";
  pen.fillText("1", left + 130, top + 13 + 10 * pen.unit);
  pen.textAlign = "left";
  pen.fillStyle = INK;
  pen.fillText("density / its maximum", left, top - 12 * pen.unit);
  ring(pen, left + 6, top + 58, now.model.name);
  pen.fillStyle = INK;
  pen.fillText("draw", left + 18, top + 58);
  pen.fillStyle = SOFT;
  pen.fillText("Squares: best over the", left, top + 96);
  pen.fillText("third parameter", left, top + 96 + 17 * pen.unit);
}

startMaps();
