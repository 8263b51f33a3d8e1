// Players of walks: one per scene. Captured and simulated walks run in their own time from a common start.
const STAGE = { wide: 1040, narrow: 620, height: 560, margin: 40 };
const PARTS = { arrived: "arrived", passed: "missed the end: turned too widely", timeout: "still under way at the time limit" };

function startPlayers() {
  for (const root of document.querySelectorAll(".player")) { startPlayer(root, DATA.scenes[Number(root.dataset.scene)]); }
}

function startPlayer(root, scene) {
  if (!scene.walks.length) { return; }
  root.querySelector(".names").textContent = scene.parameters.map(symbolOf).join(", ");
  const canvas = root.querySelector("canvas"), readout = root.querySelector(".readout");
  const state = { walk: 0, frame: 0, playing: false, shown: new Set(scene.models), speed: 1, started: 0 };
  const last = () => Math.max(...tracks(scene.walks[state.walk], state).map((track) => track.count)) - 1;
  const scrub = slider("time", 2, 0, (i) => (i * scene.frame_s).toFixed(2) + " s", (i) => { pause(); state.frame = i; draw(); });
  const scrubber = scrub.querySelector("input");
  const play = element("button", { type: "button", "aria-pressed": "false" }, "Play");

  function draw() {
    const width = canvas.clientWidth < 600 ? STAGE.narrow : STAGE.wide;
    drawStage(canvas, scene, state, fitting(scene, width));
    const frame = Math.floor(state.frame);
    scrubber.max = String(last());
    scrubber.value = String(frame);
    const time = (frame * scene.frame_s).toFixed(2) + " s";
    scrubber.setAttribute("aria-valuetext", time);
    scrub.querySelector("output").textContent = time;
    const walk = scene.walks[state.walk];
    readout.textContent = walk.participant.replace(/^scenarios_/, "") + ", " + walk.configuration.replace(/-/g, " to ").replace(/_/g, " ") +
      ", walk " + (state.walk + 1) + " of " + scene.walks.length;
  }

  function pause() {
    state.playing = false;
    play.textContent = "Play";
    play.setAttribute("aria-pressed", "false");
  }

  function step(now) {
    if (!state.playing) { return; }
    state.frame += (now - state.started) / 1000 * state.speed / scene.frame_s;
    state.started = now;
    if (state.frame >= last()) { state.frame = last(); pause(); }
    draw();
    requestAnimationFrame(step);
  }

  play.addEventListener("click", () => {
    if (state.playing) { pause(); return; }
    if (state.frame >= last()) { state.frame = 0; }
    state.playing = true;
    play.textContent = "Pause";
    play.setAttribute("aria-pressed", "true");
    requestAnimationFrame((now) => { state.started = now; step(now); });
  });

  function choose(index) {
    pause();
    state.walk = index;
    state.frame = 0;
    picker.select.value = String(index);
    outcome(root, scene.walks[index]);
    state.frame = last();  // a still picture of the whole walk; Play starts from its beginning
    draw();
  }

  const picker = chooser("Walk", scene.walks.map((walk) => walk.participant.replace(/^scenarios_/, "") + ": " +
    walk.configuration.replace(/-/g, " to ").replace(/_/g, " ")), choose);
  const move = (by) => choose((state.walk + by + scene.walks.length) % scene.walks.length);
  const previous = element("button", { type: "button" }, "Previous walk"), next = element("button", { type: "button" }, "Next walk");
  previous.addEventListener("click", () => move(-1));
  next.addEventListener("click", () => move(1));
  const speed = chooser("Speed", ["1 ×", "½ ×", "¼ ×"], (i) => { state.speed = [1, 0.5, 0.25][i]; });
  const models = element("fieldset", { class: "row plain" }, element("legend", {}, "Shown beside the captured walk"), ...scene.models.map((name) => {
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => { if (box.checked) { state.shown.add(name); } else { state.shown.delete(name); } draw(); });
    const swatch = element("span", { class: "swatch" });
    swatch.style.background = colourOf(name);
    return element("label", { class: "check" }, element("span", {}, box, " ", swatch, " ", ...modelName(name)));
  }));
  root.querySelector(".controls").append(
    picker.field, element("div", { class: "row" }, previous, next), element("div", { class: "row" }, play), speed.field, scrub, models,
  );
  choose(longest(scene.walks));
  new ResizeObserver(draw).observe(canvas);
}

// The walk to begin with: the longest captured path has most to show.
function longest(walks) {
  return walks.reduce((best, walk, index) => (walk.captured.length > walks[best].captured.length ? index : best), 0);
}

// What runs in the picture: the captured walk first, then the models that are shown.
function tracks(walk, state) {
  const shown = walk.trials.filter((trial) => state.shown.has(trial.model));
  return [{ model: "Ref", path: walk.captured }, ...shown].map((track) => ({ ...track, count: track.path.length / 2 }));
}

// Scale and place of the plan in the picture: all captured walks fit, with some ground round them; what stands farther off is cut.
function fitting(scene, width) {
  const xs = [], ys = [];
  const add = (path) => { for (let i = 0; i < path.length; i += 2) { xs.push(path[i]); ys.push(path[i + 1]); } };
  scene.stations.forEach((station) => add(station.at));
  scene.walks.forEach((walk) => add(walk.captured));
  const round = 70;  // cm
  const left = Math.min(...xs) - round, right = Math.max(...xs) + round, low = Math.min(...ys) - round, high = Math.max(...ys) + round;
  const factor = Math.min(width / (right - left), STAGE.height / (high - low));
  const x0 = width / 2 - factor * (left + right) / 2, y0 = STAGE.height / 2 + factor * (low + high) / 2;
  return { factor, width, x: (cm) => x0 + factor * cm, y: (cm) => y0 - factor * cm };
}

function drawStage(canvas, scene, state, scale) {
  const pen = context(canvas, scale.width, STAGE.height);
  const unit = Math.max(1, 0.8 * pen.unit);
  pen.font = 14 * pen.unit + "px system-ui, sans-serif";
  const trace = (path, from, to) => {
    pen.beginPath();
    for (let i = from; i <= to; i += 1) { pen.lineTo(scale.x(path[2 * i]), scale.y(path[2 * i + 1])); }
  };
  for (const obstacle of scene.obstacles) {
    trace(obstacle.outline, 0, obstacle.outline.length / 2 - 1);
    pen.fillStyle = OBSTACLE;
    pen.fill();
    const middle = centre(obstacle.outline);
    pen.fillStyle = SOFT;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    // The name of what is partly cut stays in the picture.
    const inside = (value, size) => Math.min(Math.max(value, STAGE.margin), size - STAGE.margin);
    pen.fillText(obstacle.name.replace(/_/g, " "), inside(scale.x(middle.x), scale.width), inside(scale.y(middle.y), STAGE.height));
  }
  const walk = scene.walks[state.walk];
  pen.lineWidth = 1;
  pen.strokeStyle = "#b9c0c7";
  for (const other of scene.walks) {
    if (other.configuration === walk.configuration) { trace(other.captured, 0, other.captured.length / 2 - 1); pen.stroke(); }
  }
  for (const station of scene.stations) {
    pen.strokeStyle = INK;
    pen.lineWidth = 1.5;
    pen.strokeRect(scale.x(station.at[0]) - 6, scale.y(station.at[1]) - 6, 12, 12);
  }
  const frame = Math.floor(state.frame), half = Math.round(0.5 / scene.frame_s);
  for (const track of tracks(walk, state).reverse()) {
    const to = Math.min(frame, track.count - 1), hue = colourOf(track.model);
    pen.strokeStyle = hue;
    pen.fillStyle = hue;
    pen.lineWidth = 3 * unit;
    trace(track.path, 0, to);
    pen.stroke();
    for (let i = 0; i <= to; i += half) { dot(pen, scale.x(track.path[2 * i]), scale.y(track.path[2 * i + 1]), 4 * unit); }
    dot(pen, scale.x(track.path[2 * to]), scale.y(track.path[2 * to + 1]), 9 * unit);
  }
  drawLength(pen, scale);
}

function dot(pen, x, y, radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

function centre(path) {
  let x = 0, y = 0;
  const count = path.length / 2 - 1;  // an outline ends where it starts
  for (let i = 0; i < count; i += 1) { x += path[2 * i] / count; y += path[2 * i + 1] / count; }
  return { x, y };
}

// One metre, so that the picture has a scale.
function drawLength(pen, scale) {
  const x = scale.width - STAGE.margin - scale.factor * 100, y = STAGE.height - 18;
  pen.strokeStyle = INK;
  pen.lineWidth = 2;
  pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x + scale.factor * 100, y); pen.stroke();
  pen.fillStyle = INK;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  pen.fillText("1 m", x - 8, y);
}

function outcome(root, walk) {
  const body = root.querySelector(".outcome tbody");
  const labels = Array.from(root.querySelectorAll(".outcome th"), (heading) => heading.textContent);
  const cell = (column, kind, ...inner) => element("td", { class: kind, "data-label": column ? labels[column] : "" }, ...inner);
  const rows = [element("tr", {}, cell(0, "head", "captured"), cell(1, "number", walk.captured_s.toFixed(2)),
    cell(2, "number none"), cell(3, "none"), cell(4, "none"))];
  for (const trial of walk.trials) {
    const sign = trial.dt_s > 0 ? "+" : "";
    rows.push(element("tr", {},
      cell(0, "head", ...modelName(trial.model)), cell(1, "number", trial.simulated_s.toFixed(2)),
      cell(2, "number", sign + trial.dt_s.toFixed(2)),
      cell(3, "", trial.parameters.map((value) => value.toFixed(2)).join(", ")),
      cell(4, "", (PARTS[trial.arrival] || trial.arrival) + (trial.collided ? ", through an obstacle" : ""))));
  }
  body.replaceChildren(...rows);
}

startPlayers();
