// What the view of maps and the players share: the page's data, bytes, colours, canvases and controls.
const DATA = JSON.parse(document.getElementById("data").textContent);
// The plates are white in both modes, so these are constant; colours of models come with the data.
const INK = "#1b1f24", SOFT = "#5f6870", FAINT = "#c8c8c8", OBSTACLE = "#d9d9d9", PUBLISHED = "#6e6e6e";
// Seven colours of viridis, evenly spaced; yellow is suitable, as in the figures.
const VIRIDIS = [[68, 1, 84], [68, 57, 131], [49, 104, 142], [33, 145, 140], [53, 183, 121], [144, 215, 67], [253, 231, 37]];

function viridis(share) {
  const at = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const low = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const mixed = VIRIDIS[low].map((value, i) => Math.round(value + (at - low) * (VIRIDIS[low + 1][i] - value)));
  return "rgb(" + mixed.join(",") + ")";
}

function bytesOf(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

function colourOf(model) {
  const names = Object.keys(DATA.colours).filter(Boolean).sort((a, b) => b.length - a.length);
  return DATA.colours[names.find((name) => model === name || model.startsWith(name + " ")) || ""];
}

// A canvas with as many pixels as the screen has, to be drawn on in units of its design size. `pen.unit` is one CSS pixel in
// these units: letters and marks keep their size on a small screen.
function context(canvas, width, height) {
  const shown = (canvas.clientWidth || width) / width;
  const scale = Math.max(1, Math.min(3, shown * (window.devicePixelRatio || 1)));
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, width, height);
  pen.unit = Math.min(1.4, Math.max(1, 1 / shown));
  pen.font = 13 * pen.unit + "px system-ui, sans-serif";
  return pen;
}

function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name in made && typeof value !== "string") { made[name] = value; } else { made.setAttribute(name, value); }
  }
  made.append(...children);
  return made;
}

// A model's name with its index set low, as text nodes: names are data.
function modelName(name) {
  const found = /^P_([^ ]+)(.*)$/.exec(name === "P_Prob" ? "P_Prob (literal)" : name);
  return found ? ["P", element("sub", {}, found[1]), found[2]] : [name];
}

let sliders = 0;

// A labelled slider; `text` says what a position means. Arrow keys, Home and End come with the element.
function slider(label, count, start, text, changed) {
  sliders += 1;
  const id = "slider-" + sliders;
  const output = element("output", { for: id }, text(start));
  const input = element("input", { id, type: "range", min: "0", max: String(count - 1), step: "1", value: String(start) });
  input.setAttribute("aria-valuetext", text(start));
  input.addEventListener("input", () => {
    output.textContent = text(Number(input.value));
    input.setAttribute("aria-valuetext", text(Number(input.value)));
    changed(Number(input.value));
  });
  // The label points at the slider: an output inside of it would take it for itself.
  return element("div", { class: "wide" }, element("label", { for: id }, label), " ", output, input);
}

function chooser(label, options, changed) {
  const select = element("select", {}, ...options.map((text, index) => element("option", { value: String(index) }, text)));
  select.addEventListener("change", () => changed(Number(select.value)));
  return { field: element("label", {}, element("span", {}, label), select), select };
}

function symbolOf(name) {
  const greek = { omega: "ω", tau: "τ", alpha: "α", beta: "β", gamma: "γ", theta: "θ", kappa: "κ", sigma: "σ", lambda: "λ", mu: "μ" };
  return greek[name] || name.replace(/_/g, " ");
}

function withUnit(name, unit) {
  return unit && unit !== "1" ? symbolOf(name) + " (" + unit + ")" : symbolOf(name);
}
