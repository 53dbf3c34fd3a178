// The section of the tensions: of sets of cables with their bounds, over load cases and samples; of each cable.

const LOW_PART = 0.05, // of the samples, below the range that the table shows
  HIGH_PART = 0.95;

// Returns the cables of a set, which may be one of the groups; of all cables for "" and "all". Several names are joined
// by +.
function cablesOf(name) {
  if (name.includes("+")) return [...new Set(name.split("+").flatMap(cablesOf))];
  const found = net.sets.find((set) => set.name === name),
    all = Array.from({ length: net.n_cable }, (_, e) => e);
  return found ? Array.from(found.cable) : all.filter((e) => name === "" || name === "all" || groupOf(e) === name);
}

// Returns the value that this part of the samples does not exceed, or null.
function quantileOf(curve, part) {
  const k = curve ? curve.share.findIndex((share) => share >= part - 1e-6) : -1;
  return k >= 0 ? curve.value[k] : null;
}

// Returns the tightest of the bounds in these rows, or null.
function tightest(rows, key) {
  const values = rows.map((row) => row[key]).filter(hasNumber);
  if (!values.length) return null;
  return key === "at_least" ? Math.max(...values) : Math.min(...values);
}

// Returns one row for each set and load case: its range, that of the samples, and the bounds. Sets with bounds come
// first.
function tensionRows() {
  const required = judged().filter(({ figure: of }) => of === "tension"),
    limits = data.limits || [],
    shapes = data.shapes.filter((s) => s === resultShape || s === otherShape || s.load_case);
  const named = net.sets.length ? net.sets.map(({ name }) => name) : net.group_word,
    names = new Set([...[...required, ...limits].map(({ set }) => set), ...named]);
  return [...names].flatMap((set) => {
    const cables = cablesOf(set);
    return shapes.flatMap((shape) => {
      const state = shape.load_case || "nominal",
        rows = required.filter((row) => row.set === set && (row.load_case === "all" || row.load_case === state)),
        isOther = shape === otherShape,
        curve = (bound) =>
          isOther
            ? undefined
            : rows.flatMap(({ curves }) => curves).find((c) => c.load_case === state && c.bound === bound);
      const tensions = range(cables.map((e) => shape.tension_N[e]));
      return tensions
        ? {
            set: familyName(set) || "all",
            state: other ? shape.name : state,
            tensions,
            samples: [quantileOf(curve("at_least"), LOW_PART), quantileOf(curve("at_most"), HIGH_PART)],
            required: isOther ? [null, null] : [tightest(rows, "at_least"), tightest(rows, "at_most")],
            // limits of the search hold for the nominal net
            limits: ["at_least", "at_most"].map((key) =>
              shape === resultShape
                ? tightest(
                    limits.filter((row) => row.set === set),
                    key,
                  )
                : null,
            ),
          }
        : [];
    });
  });
}

// Draws the range of a row as a bar, the samples as thin lines beyond it, and bounds as vertical marks.
function rangePicture(row, [low, high]) {
  const x = (v) => 4 + (192 * (v - low)) / (high - low || 1),
    mark = (kind) => (v) => (hasNumber(v) ? svg("path", { class: kind, d: `M${x(v).toFixed(1)} 0V18` }) : null),
    line = (kind, from, to) => svg("path", { class: kind, d: `M${x(from).toFixed(1)} 9H${x(to).toFixed(1)}` });
  const [least, most] = row.tensions,
    [few, many] = row.samples;
  return svg(
    "svg",
    { class: "range", viewBox: "0 0 200 18", "aria-hidden": "true" },
    line("samples", hasNumber(few) ? few : least, hasNumber(many) ? many : most),
    line("tensions", least - 0.01 * (high - low), most + 0.01 * (high - low)),
    row.limits.map(mark("limit")),
    row.required.map(mark("bound")),
  );
}

const boundsText = ([low, high]) =>
  hasNumber(low) && hasNumber(high)
    ? `${fmt(low)} to ${fmt(high)}`
    : hasNumber(low)
      ? `≥ ${fmt(low)}`
      : hasNumber(high)
        ? `≤ ${fmt(high)}`
        : "–";

// Returns the table of sets, or nothing if there is neither a bound nor a load case.
function tensionTable() {
  const rows = tensionRows(),
    values = (key) => rows.flatMap((row) => row[key]).filter(hasNumber),
    bounds = [...values("required"), ...values("limits")];
  if (!bounds.length && !data.shapes.some((s) => s.load_case)) return [];
  const ends = new Map(); // the axis of each set
  for (const row of rows) {
    const before = ends.get(row.set) || [];
    ends.set(row.set, range([...before, ...row.tensions, ...row.samples, ...row.required, ...row.limits]));
  }
  const number = (name, of) => ({ name, number: true, of: (i) => of(rows[i]), show: (i) => fmt(of(rows[i]), 4) }),
    text = (name, of) => ({ name, of: (i) => of(rows[i]), show: (i) => of(rows[i]) }),
    hasSamples = values("samples").length > 0,
    bounded = rows.filter(({ required, limits }) => [...required, ...limits].some(hasNumber)).length;
  const columns = [
    text("Set", ({ set }) => set),
    { ...text(other ? "Result" : "Load case", ({ state }) => state), beside: true },
    number("minimum (N)", ({ tensions }) => tensions[0]),
    number("maximum (N)", ({ tensions }) => tensions[1]),
    hasSamples ? number("minimum, 5 % of the samples (N)", ({ samples }) => samples[0]) : null,
    hasSamples ? number("maximum, 95 % of the samples (N)", ({ samples }) => samples[1]) : null,
    values("required").length ? text("required (N)", ({ required }) => boundsText(required)) : null,
    values("limits").length ? text("limits of the search (N)", ({ limits }) => boundsText(limits)) : null,
    { name: "range", of: (i) => rows[i].tensions[0], show: (i) => rangePicture(rows[i], ends.get(rows[i].set)) },
  ].filter((column) => column);
  const words = [
    "The table lists the tensions of each set of cables. Bars show their range.",
    hasSamples
      ? "Thin lines extend to the minimum that 5 % and the maximum that 95 % of the samples do not exceed."
      : "",
    bounds.length ? "Vertical marks are required bounds (solid) and limits of the search (dashed)." : "",
  ].filter((word) => word);
  return [
    el("p", {}, words.join(" ")),
    sortableTable({ caption: "Tensions by set", columns, n: rows.length, by: -1, most: Math.max(4, bounded) }).node,
  ];
}

function tensionChart(group) {
  const name = `${group === "inner" ? "Inner" : "Boundary"} cables`,
    of = Array.from({ length: net.n_cable }, (_, e) => e).filter((e) => groupOf(e) === group);
  if (!of.length) return null;
  const colour = { form: "--one", search: "--two", refine: "--three", other: "--four" };
  const shapes = data.shapes.filter((s) => !s.load_case),
    [low, high] = range(shapes.flatMap((s) => of.map((e) => s.tension_N[e]))) || [0, 1];
  if (high - low < 1e-6 * high)
    return el(
      "div",
      {},
      el("h3", {}, name),
      el(
        "p",
        {},
        `${of.length > 1 ? `All ${fmtCount(of.length)} have` : `${shown(net.cable_id[of[0]])} has`} ` +
          `${digitsOf(high, 5)} N${shapes[1] ? " in every shape" : ""}.`,
      ),
    );
  return chart({
    title: name,
    xLabel: "cable number",
    yLabel: "tension (N)",
    unit: "N",
    x: of.map((_, k) => k + 1),
    head: (k) => `cable ${net.cable_id[of[k]]}`,
    series: shapes.map((s, k) => ({
      name: s.name,
      stored: "tension_N",
      values: of.map((e) => s.tension_N[e]),
      colour: colour[s.stage],
      dots: true,
      size: (of.length > 300 ? 2.5 : 4) + 2 * (shapes.length - 1 - k), // larger marks below others remain visible
    })),
  });
}

function writeTensions() {
  if (!data.shapes.length) return;
  section(
    "tensions",
    "Tensions",
    ...tensionTable(),
    el(
      "p",
      {},
      "Each mark of the charts is one cable. The cable numbers of each group follow the order of the result file.",
    ),
    el("div", { class: "charts" }, tensionChart("inner"), tensionChart("boundary")),
  );
}
