// The section of the Pareto front of optimize.front, with a chart for each pair of objectives.

// Names of objectives for people: without their number, lengths in mm.
const objectiveName = (key) => key.replace(/^objective_[0-9]+_/, "").replace(/_/g, " ").replace(/^psi\b/, "ψ");
const storedUnit = (key) => ({ ...(other && other.objective_unit), ...data.objective_unit })[key] || "";
const objectiveUnit = (key) => (storedUnit(key) === "m" ? "mm" : storedUnit(key));
const objectiveScale = (key) => (storedUnit(key) === "m" ? 1e3 : 1);
const objectiveLabel = (key) => objectiveName(key) + (objectiveUnit(key) ? ` (${objectiveUnit(key)})` : "");
const objectiveText = (key, value) => `${fmt(value, 6)} ${objectiveUnit(key)}`.trim();

const valueIn = (objective, key) =>
  typeof objective[key] === "number" ? objectiveScale(key) * objective[key] : null;

// Returns the points of the front in ascending order of objective a, with the initial design among them. A series
// without a value at a point has undefined there, so its line continues.
function frontPositions(front, a, b) {
  const position = (objective) => ({ x: valueIn(objective, a), y: valueIn(objective, b) });
  const positions = front.points
    .map((point, i) => ({ ...position(point.objective), point, i }))
    .filter(({ point }) => point.mark !== "failed");
  const initial = position(front.initial);
  if (typeof initial.x === "number" && typeof initial.y === "number") positions.push(initial);
  return positions.filter(({ x }) => typeof x === "number").sort((p, q) => p.x - q.x);
}

// Returns the name of a point: its values.
const pointValues = (objective) =>
  Object.entries(objective)
    .map(([key, value]) => `${objectiveName(key)} ${objectiveText(key, objectiveScale(key) * value)}`)
    .join(", ");

// Returns the verdict on a point, or "" if the file has none.
const verdictOn = ({ verdict }) => verdict || "";
const MARK = { on: "on the front", dominated: "dominated by another point", failed: "no feasible design" };

// Returns the table of the points, with the change of the minimised objective per unit of each other one.
function frontTable(front, names) {
  const { points, minimised } = front,
    number = (name, of, digits) => ({ name, number: true, of, show: (i) => digitsOf(of(i), digits) });
  const slopes = names.filter((key) => minimised && key !== minimised).map((key) => {
    const unit = `${objectiveUnit(minimised) || "1"} per ${objectiveUnit(key) || "1"}`,
      scale = objectiveScale(minimised) / objectiveScale(key);
    const of = ({ multiplier = {} }) => (typeof multiplier[key] === "number" ? -scale * multiplier[key] || 0 : null);
    return number(`${objectiveName(minimised)} per ${objectiveName(key)} (${unit})`, (i) => of(points[i]), 3);
  });
  const position = (i) => (i === front.knee ? "knee" : MARK[points[i].mark] || points[i].mark),
    verdict = (i) => {
      const { requirements_failed: failed, requirements_undecided: open } = points[i],
        n = failed || open;
      return verdictOn(points[i]) + (n ? ` (${fmtCount(n)})` : "") || "–";
    };
  return sortableTable({
    caption: "Points of the front",
    columns: [
      ...names.map((key) => {
        const of = (i) => valueIn(points[i].objective, key);
        return number(objectiveLabel(key), of, 5);
      }),
      ...slopes,
      { name: "Position", of: position, show: position },
      ...(points.some(verdictOn) ? [{ name: "Verdict", of: verdict, show: verdict }] : []),
      { name: "Number for --point", number: true, of: (i) => points[i].id, show: (i) => fmtCount(points[i].id) },
    ],
    n: points.length,
    by: -1,
  }).node;
}

function frontChart(front, a, b) {
  const positions = frontPositions(front, a, b),
    isCurve = Object.keys(front.initial).length === 2;
  const series = (name, colour, dots, isDrawn) => ({
    name,
    colour,
    dots,
    values: positions.map((position) => (isDrawn(position) ? position.y : undefined)),
  });
  const initial = positions.find(({ point }) => !point),
    [low, high] = range(positions.filter((position) => position !== initial).map(({ y }) => y)) || [0, 1],
    isFar = !!initial && (initial.y < low - REACH * (high - low) || initial.y > high + REACH * (high - low));
  const marked =
    (mark) =>
    ({ point }) =>
      !!point && point.mark === mark;
  const all = [
    { ...series("front", "--one", !isCurve, marked("on")), isMarked: true },
    series("dominated", "--ghost", true, marked("dominated")),
    ...Object.entries(VERDICTS).map(([verdict, [name, , colour]]) => ({
      ...series(name, colour, true, ({ point }) => !!point && verdictOn(point) === verdict),
      size: 7,
    })),
    { ...series("knee", "--three", true, ({ point, i }) => !!point && i === front.knee), size: 9 },
    { ...series("initial design", "--two", true, ({ point }) => !point), free: isFar },
  ];
  return chart({
    title: `${objectiveName(b)} against ${objectiveName(a)}`,
    xLabel: objectiveLabel(a),
    yLabel: objectiveLabel(b),
    unit: objectiveUnit(b),
    caption: isFar
      ? `The ${objectiveName(b)} of the initial design (${objectiveText(b, initial.y)}) is outside the plotted range.`
      : null,
    x: positions.map(({ x }) => x),
    counted: false,
    log: false,
    head: (i) =>
      positions[i].point ? pointValues(positions[i].point.objective) : `initial design: ${pointValues(front.initial)}`,
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
    "To get a result with a shape, a cut list and the as-built net of a point, run the command of this run with " +
      "--point: ",
    el("code", {}, pointCommand(front)),
  );

// Explains which shape the page shows, because a front has no shape of its own. With two results, their table does.
function whoseText(front) {
  if (!front || !resultShape) return null;
  const asBuilt = summary.load_cases || summary.tolerance;
  return el(
    "p",
    { id: "whose" },
    resultStage === "form"
      ? "The sections from here on show the shape after form-finding. This shape is not a point of the front."
      : "The sections from here on show the point of the front with the minimum " +
          `${objectiveName(Object.keys(front.initial)[0])}.` +
          `${asBuilt ? " The as-built nets are computed for the shape after form-finding." : ""}`,
    data.gain_loss ? ` Of this shape: ${data.gain_loss}.` : "",
  );
}

// Writes the section of a front whose objectives do not conflict.
function writeOneDesign(front, names, point) {
  const valueOf = (name, value) =>
    storedUnit(name) === "m" ? `${roundedMm(value)} mm` : objectiveText(name, value);
  const values = names.map((name) => `${objectiveName(name)} ${valueOf(name, point.objective[name])}`);
  section(
    "front",
    "One design for all objectives",
    other ? null : answerText("answer", data),
    el(
      "p",
      {},
      `The objectives do not conflict. Point ${point.id} minimises all objectives (${values.join(", ")}). ` +
        `The computation took ${fmtDuration(front.wall_s)}.`,
    ),
    takeText(front),
  );
}

function writeFront() {
  const front = summary.front;
  if (!front) return;
  const names = Object.keys(front.initial),
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
    other ? null : answerText("answer", data),
    frontTable(front, names),
    el(
      "p",
      {},
      `${fmtCount(front.n_point)} designs${left.length ? `, ${left.join(", ")}` : ""}. No known design is better ` +
        `than a design on the front in all objectives. ` +
        `The computation took ${fmtDuration(front.wall_s)}. The knee is the ` +
        `point farthest below the ${names.length > 2 ? "plane through" : "straight line between"} the ends.`,
    ),
    el("div", { class: "charts" }, charts),
    takeText(front),
  );
}
