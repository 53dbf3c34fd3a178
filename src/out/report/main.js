// Contents: sections, head, net and map, the page.

const main = document.getElementById("main");

// Sections that have both of two results, or name their file. The title of the others begins with it.
const OF_BOTH = ["requirements", "requirements-other", "compare", "net", "cables", "map", "tensions", "far-field"];

function section(id, name, ...children) {
  const title = OF_BOTH.includes(id) ? name : ofThis(name);
  document.getElementById("contents").append(el("a", { href: `#${id}` }, title));
  const heading = el("h2", { id: `${id}-title` }, title);
  const node = el("section", { id, "aria-labelledby": `${id}-title` }, heading, ...children),
    tools = node.querySelector(":scope > .tools:has(input[type=radio])");
  if (tools) tools.after(chosenLine(tools));
  main.append(node);
  return node;
}

// ---- head: title, warnings, the main figures ----

function writeHead() {
  document.getElementById("title").textContent = shown(other ? `${thisName} and ${otherName}` : data.title);
  const [least, most] = [summary.scale_min, summary.scale_max].map(fmt);
  const scaled = summary.scale_min > 0 && (least === most ? least : `${least} to ${most}`);
  const found =
    `${fmtCount(net.n_node)} nodes (${fmtCount(data.n_free)} free), ${fmtCount(net.n_cable)} cables, ` +
    (data.n_variable ? `${fmtCount(data.n_variable)} design variables, ` : "") +
    (data.pretension_N === null
      ? "each cable with a law of its own"
      : `pretension ${fmt(data.pretension_N)} N${scaled ? " before optimisation" : ""}`) +
    (scaled ? `; the result scales variables by ${scaled}` : "");
  const truss = summary.truss
    ? `; truss of ${fmtCount(summary.truss.nodes)} nodes, ${fmtCount(summary.truss.members)} members, ` +
      `${fmt(summary.truss.mass_kg)} kg`
    : "";
  document.getElementById("subtitle").textContent = ofThis(found + truss);
  document.getElementById("footer").textContent = shown(
    [summary, ...(other ? [other.summary] : [])]
      .map(({ version, file }) => `Version ${version} of hifdm computed the results in ${file}.`)
      .join(" "),
  );
}

function writeWarnings(title, lines) {
  if (!lines.length) return;
  main.append(
    el(
      "div",
      { class: "warnings", role: "note", id: "warnings" },
      el("h2", {}, title),
      el(
        "ul",
        {},
        lines.map((t) => el("li", {}, t)),
      ),
    ),
  );
}

// Writes errors and warnings; with two results those of both, each with the name of its file.
function writeMessages() {
  const linesOf = (key) => [
    ...(summary[key] || []).map(ofThis),
    ...((other && other.summary[key]) || []).map(ofOther),
  ];
  const lines = [...linesOf("errors"), ...linesOf("warnings")],
    isOfForm = resultStage === "form" && summary.status !== "not_converged"; // otherwise the form-finding itself failed
  let title = lines.length === 1 ? "One warning" : `${lines.length} warnings`;
  if (other && other.summary.errors) title = `The run of ${otherName} failed`;
  if (summary.errors)
    title =
      `${other ? `The run of ${thisName}` : "This run"} failed` +
      (isOfForm ? ": its figures are those of the form-finding" : "");
  if (other && summary.errors && other.summary.errors) title = "Both runs failed";
  writeWarnings(title, lines);
}

// Returns a line for print with the choices of the controls, which paper does not have.
function chosenLine(tools) {
  const line = el("div", { class: "paper muted" });
  const write = () => {
    const sets = [...tools.querySelectorAll("fieldset:has(input:checked[type=radio])")],
      name = (set) => set.querySelector("legend").textContent.trim(),
      chosen = (set) => set.querySelector(":checked").parentNode.textContent;
    line.textContent = sets.map((set) => `${name(set)}: ${chosen(set)}`).join(" · ");
  };
  tools.addEventListener("change", write);
  write();
  return line;
}

const resultStage = resultShape && resultShape.stage;
const resultNumbers = summary[resultStage];

const figure = (name, value, unit) =>
  el("div", {}, el("dt", {}, name), el("dd", {}, value, unit && value !== "–" ? el("small", {}, unit) : null));

// Writes the answer in the words of the program's summary; with two results, of both.
function answerText(id, of, name) {
  const said = [of.answer, of.gain_loss].filter((text) => text);
  if (!said.length) return null;
  const [answer, ...more] = said.map(sentence);
  const beside = more.length && !summary.front ? el("small", {}, more) : null;
  return el("p", { class: "answer", id }, name ? `${name}: ` : "", answer, beside);
}
function writeAnswers() {
  if (!summary.front || other) main.append(answerText("answer", data, thisName) || "");
  if (other) main.append(answerText("answer-other", other, otherName) || "");
}

function writeFigures() {
  // Of two results, the comparison has the figures. A front has the table of its points.
  if (!resultNumbers || other || summary.front) return;
  // Other objectives than ψ may raise ψ.
  const initial = summary.search && !summary.form.objectives && summary.search.initial_psi_m,
    list = [];
  list.push(figure(`surface error ψ${countedText()} (${resultShape.name})`, roundedMm(resultNumbers.psi_m), "mm"));
  if (resultStage !== "form") {
    list.push(figure("ψ after form-finding", roundedMm(summary.form.psi_m), "mm"));
    const below = 100 * (1 - resultNumbers.psi_m / initial),
      size = Math.abs(below).toFixed(2),
      side = Number(size) === 0 ? "against" : below > 0 ? "below" : "above";
    if (1e3 * initial >= RESOLVED_MM)
      list.push(figure(`ψ ${side} that of the initial design`, size, "%"));
  }
  list.push(
    figure("tension ratio, inner cables", fmtRatio(resultNumbers.inner_tension_ratio)),
    figure("tension ratio, boundary cables", fmtRatio(resultNumbers.boundary_tension_ratio)),
    figure("slack cables", fmtCount(resultNumbers.slack_cables)),
  );
  if (resultStage !== "form" && summary.form.n_uncounted)
    list.push(figure("maximum displacement of an uncounted node", roundedMm(summary.form.uncounted_move_m), "mm"));
  main.append(el("dl", { class: "figures" }, list));
}

// ---- net and map ----

function choice(name, label, options, chosen, act) {
  return el(
    "fieldset",
    {},
    el("legend", {}, `${label} `),
    options.map(([value, text]) => {
      const input = el("input", { type: "radio", name, value, checked: value === chosen });
      input.addEventListener("change", () => act(value));
      return el("label", {}, input, text);
    }),
  );
}
function tick(label, checked, act) {
  const input = el("input", { type: "checkbox", checked });
  input.addEventListener("change", () => act(input.checked));
  return el("label", {}, input, label);
}
function button(text, name, act) {
  const node = el("button", { type: "button", "aria-label": name, title: name }, text);
  node.addEventListener("click", act);
  return node;
}

// Scale factors 1, 2, 5, 10, ... The first one chosen draws the maximum deviation as a twentieth of the size of the
// net.
const SCALES = Array.from({ length: 22 }, (_, k) => [1, 2, 5][k % 3] * 10 ** Math.floor(k / 3));
function scaleWithin(most_m, radius) {
  const scale = 1e3 * most_m > RESOLVED_MM ? (0.1 * radius) / most_m : 1;
  return Math.max(0, SCALES.filter((s) => s <= scale).length - 1);
}
function firstScale(radius) {
  const stages = data.shapes.filter((s) => !s.load_case); // nodes of a load case may move much farther
  return scaleWithin(Math.max(0, ...stages.map((s) => range(s.distance_mm)[1])) / 1e3, radius);
}

function stage(kind, name, description) {
  const canvas = el("canvas", {
    id: `${kind}-canvas`,
    tabindex: kind === "net" ? 0 : undefined,
    role: "img",
    "aria-label": name,
    "aria-describedby": description,
  });
  const tip = el("div", { class: "tip", role: "status", hidden: true }),
    bar = el("div", { class: "bar" });
  return { canvas, tip, bar, node: el("div", { class: `stage ${kind}` }, canvas, tip) };
}

function writeNet() {
  const parts = stage("net", "The net in space", "net-keys"),
    shapes = data.shapes,
    loadCases = shapes.filter((s) => s.load_case);
  loadCases.forEach((s, k) => (s.colour = SERIES[(k + 1) % SERIES.length]));
  const output = el("output", {}),
    slider = el("input", {
      type: "range",
      min: 0,
      max: SCALES.length - 1,
      step: 1,
      "aria-label": "scale of the deformation",
    });
  const scaleLabel = (s) => {
    output.textContent = `× ${fmtCount(s)}`;
    const note = document.getElementById("scale-note");
    if (note) note.textContent = s === 1 ? "true to scale" : `enlarged ${fmtCount(s)} times`;
  };
  const overlayLabel = (chosen, factor) => {
    const keys = chosen.map(({ colour, name }) => [" ", colourKey(`var(${colour})`, name)]).flat(),
      said = ` Displacements from this shape, enlarged ${fmtCount(factor)} times:`,
      note = document.getElementById("overlay-note");
    if (note) note.replaceChildren(...(keys.length ? [said, ...keys, "."] : []));
  };
  const view = netView({ ...parts, scaleLabel, overlayLabel });
  const set = (values) => {
    Object.assign(view.state, values);
    view.redraw();
  };
  slider.value = firstScale(view.radius);
  set({ scale: SCALES[slider.value] });
  slider.addEventListener("input", () => set({ scale: SCALES[slider.value] }));
  const overlay = (shape, on) =>
    set({ overlay: loadCases.filter((s) => (s === shape ? on : view.state.overlay.includes(s))) });
  const options = [["target", "target"], ...shapes.map((s) => [s.stage, s.name])];
  const colours = [
    ["deviation", "deviation"],
    ["tension", "tension"],
    ["slack", "slack"],
    ...(net.sets.length ? [["family", "family"]] : []),
    ...(adjustmentOf.size ? [["adjustments", "adjustments"]] : []),
    ["plain", "none"],
  ];
  const showSet = (name, on) => {
    if (on) view.state.off.delete(name);
    else view.state.off.add(name);
    view.redraw();
  };
  section(
    "net",
    summary.front && resultStage === "form" ? "The net after form-finding" : "The net",
    whoseText(summary.front),
    shapes.length
      ? null
      : el("p", {}, "Because form-finding found no shape, the picture shows the net at its target positions."),
    el(
      "div",
      { class: "tools" },
      shapes.length ? choice("shape", "Shape", options, resultStage, (v) => set({ shape: shapeOf(v) })) : null,
      shapes.length ? choice("colour", "Colour", colours, view.state.colour, (v) => set({ colour: v })) : null,
      shapes.length ? el("label", {}, el("span", { class: "muted" }, "Deformation"), slider, output) : null,
      shapes.length ? tick("target positions", true, (v) => set({ target: v })) : null,
      data.truss ? tick("truss", true, (v) => set({ truss: v })) : null,
      loadCases.length
        ? el(
            "fieldset",
            { id: "overlay" },
            el("legend", {}, "Drawn over it "),
            loadCases.map((s) => tick(s.name, false, (on) => overlay(s, on))),
          )
        : null,
      familyTicks(showSet),
      el(
        "span",
        { class: "buttons" },
        button("+", "Zoom in", () => view.zoom(1.25)),
        button("−", "Zoom out", () => view.zoom(0.8)),
        button("Oblique", "View from above at an angle", () => view.look(-35, 32)),
        button("Top", "View along z", () => view.look(0, 90)),
        button("Along y", "View along y", () => view.look(0, 0)),
        button("Along x", "View along x", () => view.look(90, 0)),
      ),
    ),
    el(
      "figure",
      {},
      parts.node,
      parts.bar,
      el(
        "figcaption",
        {},
        netCaption(),
        el(
          "span",
          { class: "keys", id: "net-keys" },
          " To rotate the net, drag it or press the arrow keys. Hold Shift to move it. To zoom, turn the mouse " +
            "wheel or press + or −. Press 0 to reset the view. To step through the nodes or cables, press n or c. " +
            "Hold Shift to step backwards. To mark a cable, click it or press Enter.",
        ),
      ),
    ),
  );
  report.net = view;
}

// Returns switches for the families of cables, such as front, rear and ties. A long list of them is collapsed.
const FAMILIES_OPEN = 8;
function familyTicks(act) {
  const { sets } = net;
  if (!sets.length) return null;
  const ticks = sets.map(({ name }) => tick(familyName(name), true, (on) => act(name, on)));
  const all = el("fieldset", { id: "families" }, el("legend", {}, "Cables "), ticks);
  return sets.length <= FAMILIES_OPEN
    ? all
    : el("details", {}, el("summary", {}, `${fmtCount(sets.length)} families of cables`), all);
}

function trussNote() {
  if (!data.truss) return "";
  return data.truss.displacement_m
    ? ". The frame is the truss under the pull of the net after form-finding"
    : ". The frame is the truss";
}

function netCaption() {
  if (!data.shapes.length) return "Squares are supports.";
  return el(
    "span",
    {},
    "Deformation from the target positions (grey) ",
    el("strong", { id: "scale-note" }),
    `. Squares are supports${trussNote()}. The colour scale covers the deviations of the inner nodes.`,
    el("span", { id: "overlay-note" }),
  );
}

function writeMap() {
  if (!resultShape) return;
  const parts = stage("map", "Deviation over the aperture", "map-caption"),
    view = aperture(parts);
  const set = (values) => {
    Object.assign(view.state, values);
    view.redraw();
  };
  section(
    "map",
    "Deviation over the aperture",
    el(
      "div",
      { class: "tools" },
      choice(
        "map-shape",
        "Shape",
        data.shapes.map((s) => [s.stage, s.name]),
        resultStage,
        (v) => set({ shape: shapeOf(v) }),
      ),
      choice(
        "quantity",
        "Quantity",
        [
          ["distance", "distance"],
          ["height", "height Δz"],
          ...(net.facets
            ? [
                ["normal", "facets, along the normal"],
                ["fit", "facets, best fit"],
              ]
            : []),
        ],
        "distance",
        (v) => set({ quantity: v }),
      ),
    ),
    el(
      "figure",
      {},
      parts.node,
      parts.bar,
      el(
        "figcaption",
        { id: "map-caption" },
        "The map shows the net at its target positions, viewed along z. " +
          "The map interpolates values between the nodes. The height is positive above the target surface. " +
          "The distance from the target position includes tangential displacements, as ψ does." +
          (net.facets
            ? " The colour of a facet shows its mean error along the surface normal. The error is positive above the " +
              "target surface, or above the best fit to all facets."
            : ""),
      ),
    ),
  );
  report.map = view;
}

// ---- the page ----

const report = {}; // access to the two pictures for the console and the tests
window.report = report;
if (data.study) {
  writeStudy(data.study);
} else {
  writeHead();
  // The verdicts belong to the net after form-finding, which is no point of the front.
  if (summary.front && !other) writeFront();
  writeRequirements();
  writeMessages();
  writeAnswers();
  writeFigures();
  writeOther();
  if (other) writeFront();
  writeNet();
  writeAdjust(report.net);
  writeCables(report.net);
  writeMap();
  writeTensions();
  writeLoadCases();
  writeDistributions();
  writeTolerance();
  writePattern();
  writeSummary();
  writeHistory(); // sections from here on describe the iterations
  writeSearch();
  writeCoupling();
  writeProvenance();
}
