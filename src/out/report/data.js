// Contents: the data, elements, numbers for people, derived values.
"use strict";

// Numbers of all nodes or cables are stored as base64 of their bytes, as the only member of an object.
const PACKED = { i32: Int32Array, f32: Float32Array, f64: Float64Array };
function unpack(type, text) {
  const letters = atob(text),
    bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; k++) bytes[k] = letters.charCodeAt(k);
  return new PACKED[type](bytes.buffer);
}
// Replaces packed numbers and "Infinity" in place. A reviver of JSON.parse would be slower, because it is called for
// the id of every cable.
function revived(value) {
  if (value === "Infinity") return Infinity;
  if (value === "-Infinity") return -Infinity;
  if (value === null || typeof value !== "object") return value;
  if (Array.isArray(value)) {
    for (let k = 0; k < value.length; k++) if (typeof value[k] !== "number") value[k] = revived(value[k]);
    return value;
  }
  for (const key of Object.keys(value)) {
    if (Object.hasOwn(PACKED, key) && typeof value[key] === "string") return unpack(key, value[key]);
    value[key] = revived(value[key]);
  }
  return value;
}
const data = revived(JSON.parse(document.getElementById("data").textContent));

// ---- elements: texts become text nodes only, so nothing in a case can become markup ----

// Shows hidden characters as the program does (hf_text_escape) and cuts texts to TEXT_MAX.
const TEXT_MAX = 2000;
const clip = (text, most) => (text.length > most ? `${[...text.slice(0, most)].slice(0, -1).join("")}…` : text);
const escaped = (text) =>
  String(text).replace(
    /[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g,
    (c) => `\\${c < "\x80" ? "x" : "u"}${c.charCodeAt(0).toString(16).padStart(c < "\x80" ? 2 : 4, "0")}`,
  );
const shown = (text) => escaped(clip(String(text), TEXT_MAX));

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {}))
    if (value !== undefined && value !== null && value !== false)
      node.setAttribute(name, value === true ? "" : escaped(value));
  for (const child of children.flat())
    if (child !== undefined && child !== null) node.append(typeof child === "string" ? shown(child) : child);
  return node;
}
const el = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
const svg = (tag, attributes, ...children) =>
  fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);

// ---- numbers for people ----

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const power = (exponent) => "10" + [...String(exponent)].map((c) => RAISED[c]).join("");
const minus = (text) => text.replace(/^-/, "−");

// Formats a number with so many significant digits; tiny and huge ones as 1.2×10⁻⁷.
function fmt(value, digits = 4) {
  if (value === Infinity || value === -Infinity) return value > 0 ? "∞" : "−∞";
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e6)
    return minus(size >= 10 ** digits ? value.toFixed(0) : String(Number(value.toPrecision(digits))));
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return minus(`${Number(mantissa)}×${power(Number(exponent))}`);
}
// Formats a number with all its digits, so that numbers of a column have the same number of them: 0.89200 and 0.94694.
function digitsOf(value, digits) {
  const size = Math.abs(value);
  return size >= 1e-3 && size < 10 ** digits ? minus(value.toPrecision(digits)) : fmt(value, digits);
}
// Formats a ratio of tensions. 1 means uniform tensions, so the number of decimals is fixed, not that of digits.
const fmtRatio = (value) => (typeof value === "number" && value < 1e4 ? value.toFixed(4) : fmt(value));
const fmtCount = (value) => (typeof value === "number" ? String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f") : "–");

function fmtDuration(s) {
  if (typeof s !== "number") return "–";
  if (s < 1) return `${fmt(s * 1e3, 3)}\u00a0ms`;
  if (s < 59.95) return `${fmt(s, 3)}\u00a0s`;
  const whole = Math.round(s),
    minutes = Math.round(s / 60); // rounded first, so that seconds or minutes never show as 60
  return whole < 3600
    ? `${Math.floor(whole / 60)} min ${whole % 60} s`
    : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

// Plain words for the stop reasons of the file. The page also has their descriptions from `hifdm explain`.
const STOP = {
  direct: "solved directly",
  rms_change: "ψ no longer changed",
  max_iterations: "the iteration limit was reached",
  ill_posed: "the net has no shape",
  diverged: "the steps grew",
  net: "the net has no shape on the deflected truss",
  generations: "the generation limit was reached",
  stagnation: "later generations gained nothing",
  all_infeasible: "a generation had no feasible design",
  settled: "five steps gained less than 0.01 %",
  running: "interrupted",
  stalled: "shorter steps gained nothing",
  taken: "taken from a front",
};
const plainWord = (word) => String(word).replace(/_/g, " ");
// Returns "certified", or why a shape has no certified error bound.
const boundText = (word) => (word === "certified" ? word : `no: ${plainWord(word)}`);
const stopText = (word) => STOP[word] || plainWord(word);
const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;

// ---- derived values ----

const net = data.net;
// Returns the number of the point of a front that is the design, or 0.
const pointIn = (figures) => (figures.refine && figures.refine.front_point) || 0;
const stageNames = (figures) => ({
  form: "form",
  search: "search",
  refine: pointIn(figures) ? `point ${pointIn(figures)} of the front` : "refine",
});
const digit = (text, i) => text.charCodeAt(i) - 48;
const innerCode = net && net.role_word.indexOf("inner"),
  isInner = (i) => digit(net.role, i) === innerCode;
const roleOf = (i) => net.role_word[digit(net.role, i)];
const groupOf = (e) => net.group_word[digit(net.group, e)];

const summary = data.summary || {},
  stageName = stageNames(summary);
// Returns the stage that is the result, as `hifdm export` chooses it; and its shape.
const resultStageIn = (figures, has) =>
  (figures.refine && figures.refine.is_result && has("refine") && "refine") ||
  (has("search") && "search") ||
  "form";
const resultIn = (figures, shapes) => {
  const of = (stage) => (shapes || []).find((shape) => shape.stage === stage);
  return of(resultStageIn(figures, of));
};
// The result for comparison. Its shape is shown with the others when it has the same net.
const { other } = data;
// With two results, both are named by their files, with as many folders as distinguish them.
function fileNames(paths) {
  const parts = paths.map((path) => path.split("/")),
    most = Math.max(...parts.map(({ length }) => length));
  let n = 1;
  const name = (of) => of.slice(-n).join("/");
  while (n < most && name(parts[0]) === name(parts[1])) n++;
  return parts.map((of) => `${n < of.length && n > 1 ? "…/" : ""}${name(of)}`);
}
const [thisName, otherName] = other
  ? fileNames([summary.file, other.summary.file]).map((name) => clip(name, 40))
  : [];
const ofThis = (text) => (other ? `${thisName}: ${text}` : text),
  ofOther = (text) => `${otherName}: ${text}`;
const otherShape = other && resultIn(other.summary, other.shapes);
const resultShape = resultIn(summary, data.shapes);
if (otherShape) data.shapes.push(otherShape);

// Sets the distance of each node from its target position and its difference in z, mm.
for (const shape of data.shapes || []) {
  const d = shape.displacement_m,
    n = net.n_node;
  shape.name = shape.load_case ? `load case ${shape.load_case}` : stageName[shape.stage];
  shape.name =
    shape === otherShape ? ofOther(stageNames(other.summary)[shape.stage]) : ofThis(shape.name);
  if (shape === otherShape) shape.stage = "other";
  shape.distance_mm = new Float64Array(n);
  shape.height_mm = new Float64Array(n);
  for (let i = 0; i < n; i++) {
    shape.distance_mm[i] = 1e3 * Math.hypot(d[3 * i], d[3 * i + 1], d[3 * i + 2]);
    shape.height_mm[i] = 1e3 * d[3 * i + 2];
  }
  shape.isSlack = (e) => Math.abs(shape.tension_N[e]) < data.slack_below_N;
}

const shapeOf = (stage) => (data.shapes || []).find((shape) => shape.stage === stage);

// Returns the upper end of the colours: the maximum deviation of the inner nodes, which psi counts. Nodes of a free
// edge move much farther, and with them all inner nodes would have one colour.
function innerMost(values) {
  let inner = -1,
    any = -1;
  for (let i = 0; i < values.length; i++) {
    const size = Math.abs(values[i]);
    if (size > any) any = size;
    if (size > inner && isInner(i)) inner = size;
  }
  return inner >= 0 ? inner : any >= 0 ? any : 1;
}

// Returns " of 11 of 59 free nodes" if psi does not count all of them. Files of earlier versions do not say so.
function countedText() {
  const n = summary.form.n_inner_node;
  return n && n < data.n_free ? ` of ${fmtCount(n)} of ${fmtCount(data.n_free)} free nodes` : "";
}

// Returns the largest deviation of a node that is not inner, or 0. on: the nodes that are looked at
function outerMost(values, on) {
  let outer = 0;
  for (let i = 0; i < values.length; i++)
    if (!isInner(i) && (!on || on[i])) outer = Math.max(outer, Math.abs(values[i]));
  return outer;
}

function range(values) {
  let low = Infinity,
    high = -Infinity;
  for (const v of values) {
    if (typeof v !== "number" || !Number.isFinite(v)) continue;
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return low <= high ? [low, high] : null;
}
