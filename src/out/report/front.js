// The section of the Pareto front of optimize.front, with a chart for each pair of objectives.

// Names of objectives for people: without their number, lengths in mm.
const objectiveName = (key) => key.replace(/^goal_[0-9]+_/, "").replace(/_/g, " ").replace(/^psi\b/, "ψ");
const goalUnit = (key) => ({ ...(data.other && data.other.goal_unit), ...data.goal_unit })[key] || "";
const objectiveUnit = (key) => (goalUnit(key) === "m" ? "mm" : goalUnit(key));
const objectiveScale = (key) => (goalUnit(key) === "m" ? 1e3 : 1);
const objectiveLabel = (key) => objectiveName(key) + (objectiveUnit(key) ? ` (${objectiveUnit(key)})` : "");
const objectiveText = (key, value) => `${fmt(value, 6)} ${objectiveUnit(key)}`.trim();

// Returns the points of the front in ascending order of objective a, with the initial design among them. A series
// without a value at a point has undefined there, so its line continues.
function frontPlaces(front, a, b) {
  const place = (objective) => {
    const at = (key) => (typeof objective[key] === "number" ? objectiveScale(key) * objective[key] : null);
    return { x: at(a), y: at(b) };
  };
  const places = front.points
    .map((point, i) => ({ ...place(point.objective), point, i }))
    .filter(({ point }) => point.mark !== "failed");
  const base = place(front.base);
  if (typeof base.x === "number" && typeof base.y === "number") places.push(base);
  return places.filter(({ x }) => typeof x === "number").sort((p, q) => p.x - q.x);
}

// Formats the changes of the minimised objective per unit of the others, where they are known.
function slopesOf(front, point) {
  return Object.entries(point.multiplier || {})
    .filter(([key, value]) => key !== front.minimised && typeof value === "number")
    .map(
      ([key, value]) =>
        `; ${fmt(value ? (-value * objectiveScale(front.minimised)) / objectiveScale(key) : 0, 3)} ` +
        `${objectiveUnit(front.minimised)} of ${objectiveName(front.minimised)} per ` +
        `${objectiveUnit(key) || "unit"} of ${objectiveName(key)}`,
    )
    .join("");
}

function frontChart(front, a, b) {
  const places = frontPlaces(front, a, b),
    isCurve = Object.keys(front.base).length === 2;
  const series = (name, colour, dots, wanted) => ({
    name,
    colour,
    dots,
    values: places.map((place) => (wanted(place) ? place.y : undefined)),
  });
  const base = places.find((place) => !place.point),
    [low, high] = range(places.filter((place) => place !== base).map(({ y }) => y)) || [0, 1],
    isFar = !!base && (base.y < low - REACH * (high - low) || base.y > high + REACH * (high - low));
  const marked = (mark) => (place) => !!place.point && place.point.mark === mark;
  const all = [
    series("front", "--one", !isCurve, marked("on")),
    series("dominated", "--ghost", true, marked("dominated")),
    { ...series("knee", "--three", true, (place) => !!place.point && place.i === front.knee), size: 9 },
    { ...series("after form-finding", "--two", true, (place) => !place.point), free: isFar },
  ];
  return chart({
    title: `${objectiveName(b)} against ${objectiveName(a)}`,
    xLabel: objectiveLabel(a),
    yLabel: objectiveLabel(b),
    unit: objectiveUnit(b),
    caption: isFar
      ? `After form-finding ${objectiveName(b)} is ${objectiveText(b, base.y)}, outside of the picture.`
      : null,
    x: places.map((place) => place.x),
    counted: false,
    log: false,
    head: (i) =>
      places[i].point
        ? `point ${places[i].point.id}: ${objectiveName(a)} ${objectiveText(a, places[i].x)}` +
          slopesOf(front, places[i].point)
        : `after form-finding: ${objectiveName(a)} ${objectiveText(a, places[i].x)}`,
    series: all.filter((s) => s.values.some((v) => v !== undefined)),
  });
}

// Returns the command that makes a point the result: the command of the front with --point.
function pointCommand(front) {
  const quoted = (text) => (/^[\w@%+=:,.\/-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`),
    sets = (data.overrides[0] || "").split("\n").filter((line) => line),
    shown = front.points[front.knee] || front.points[0];
  return ["hifdm run", quoted(summary.case), ...sets.map((set) => `--set ${quoted(set)}`)]
    .concat(`--point ${quoted(`${summary.file}:${shown.id}`)}`, `-o point${shown.id}.h5`)
    .join(" ");
}

const takeText = (front) =>
  el(
    "p",
    {},
    "A point becomes a result with a shape, a cut list, and the net as built by the command of this run with " +
      "--point: ",
    el("code", {}, pointCommand(front)),
  );

// Explains which shape the page shows, because a front has no shape of its own.
function writeWhose(told) {
  const { front } = summary;
  if (!front) return;
  const isFound = resultStage === "form",
    asBuilt = summary.cases || summary.tolerance;
  main.append(
    el(
      "p",
      { class: "whose", id: "whose" },
      isFound
        ? "Figures, net, cables and all else on this page but the front are of the form-finding’s shape, which is no " +
            "point of the front."
        : "Figures, net and cables on this page are of the end of the front with the least " +
            `${objectiveName(Object.keys(front.base)[0])}` +
            `${asBuilt ? ", nets as built of the form-finding’s shape, which is no point of the front" : ""}.`,
      told.map((text) => ` Of this shape: ${text[0].toLowerCase()}${text.slice(1)}`),
      " A point has its own in a result, of which hifdm report makes such a page: ",
      el("code", {}, pointCommand(front)),
    ),
  );
}

// Writes the section of a front whose objectives do not conflict.
function writeOneDesign(front, names, point) {
  const valueOf = (name, value) =>
    goalUnit(name) === "m" ? `${roundedMm(value)} mm` : objectiveText(name, value);
  const told = names.map((name) => `${objectiveName(name)} ${valueOf(name, point.objective[name])}`);
  section(
    "front",
    "One design for all objectives",
    el(
      "p",
      {},
      `The objectives do not conflict: one design, point ${point.id}, is best in all of them: ${told.join(", ")}. ` +
        `Found in ${fmtDuration(front.wall_s)}.`,
    ),
    takeText(front),
  );
}

function writeFront() {
  const front = summary.front;
  if (!front) return;
  const names = Object.keys(front.base),
    on = front.points.filter((point) => point.mark === "on"),
    charts = [];
  if (on.length === 1 && !front.n_failed) {
    writeOneDesign(front, names, on[0]);
    return;
  }
  for (let a = 0; a < names.length; a++)
    for (let b = a + 1; b < names.length; b++) charts.push(frontChart(front, names[a], names[b]));
  const left = [
    front.n_dominated ? `${fmtCount(front.n_dominated)} of them dominated by others` : "",
    front.n_failed ? `${fmtCount(front.n_failed)} failed` : "",
    front.n_listed < front.n_point ? `${fmtCount(front.n_listed)} of ${fmtCount(front.n_point)} shown` : "",
  ].filter((text) => text);
  section(
    "front",
    "Front of the objectives",
    el(
      "p",
      {},
      `${fmtCount(front.n_point)} designs${left.length ? `, ${left.join(", ")}` : ""}: none of the others is better ` +
        `in all objectives than one on the front. Found in ${fmtDuration(front.wall_s)}. The knee is farthest below ` +
        `the straight ${names.length > 2 ? "plane through" : "line between"} the ends.`,
    ),
    el("div", { class: "charts" }, charts),
    takeText(front),
  );
}
