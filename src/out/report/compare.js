// Compares this result with another: figures, and differences of the cases.

// Returns the lines that only one of two texts has, by the longest common subsequence: "−" of the first, "+" of the
// second.
function differences(x, y) {
  const longest = Array.from({ length: x.length + 1 }, () => new Uint16Array(y.length + 1));
  for (let i = x.length - 1; i >= 0; i--)
    for (let j = y.length - 1; j >= 0; j--)
      longest[i][j] = x[i] === y[j] ? longest[i + 1][j + 1] + 1 : Math.max(longest[i + 1][j], longest[i][j + 1]);
  const found = [];
  let i = 0,
    j = 0;
  while (i < x.length || j < y.length) {
    if (i < x.length && j < y.length && x[i] === y[j]) {
      i++;
      j++;
    } else if (j >= y.length || (i < x.length && longest[i + 1][j] >= longest[i][j + 1])) {
      found.push(["−", x[i++]]);
    } else {
      found.push(["+", y[j++]]);
    }
  }
  return found.filter(([, line]) => line.trim());
}

// Shows the differences of the cases and their overrides, without comments. Imported tables are not compared.
const LINES_OF_CASE_MAX = 600;
function caseDifferences() {
  const linesOf = (of) => `${of.case_text[0]}\n${of.overrides[0]}`.split("\n").filter((line) => !/^\s*#/.test(line));
  const all = [data, other].map(linesOf),
    left = Math.max(...all.map((text) => text.length)) - LINES_OF_CASE_MAX,
    lines = differences(...all.map((text) => text.slice(0, LINES_OF_CASE_MAX)));
  const cut =
    left > 0
      ? el(
          "p",
          {},
          `The comparison covers only the first ${LINES_OF_CASE_MAX} lines of each case file and ignores up to ` +
            `${fmtCount(left)} lines.`,
        )
      : null;
  if (!lines.length) return [left > 0 ? cut : el("p", {}, "The two case files are identical.")];
  return [
    el("h3", { class: "after" }, "Differences of the cases"),
    el("p", {}, `− of ${thisName}, + of ${otherName}.`),
    cut,
    el(
      "ul",
      { class: "differences" },
      lines.map(([sign, line]) => el("li", {}, el("code", {}, `${sign} ${line}`))),
    ),
  ];
}

// Returns the text of a number with no more decimals than the texts beside it, unless that leaves 0.
function decimalsOf(text, beside) {
  const decimals = (number) => (/^−?\d+(\.\d+)?$/.test(number) ? (number.split(".")[1] || "").length : Infinity),
    most = Math.max(...beside.map(decimals));
  const short = decimals(text) < Infinity && most < decimals(text) ? Number(text).toFixed(most) : text;
  return Number(short) === 0 ? text : short;
}

function writeOther() {
  if (!other) return;
  const [stageA, stageB] = [summary, other.summary].map((figures) => resultStageIn(figures, (stage) => figures[stage])),
    stages = [summary[stageA], other.summary[stageB]];
  const each_Hz = stages.flatMap(({ surface }) => (surface && surface.frequency_Hz) || []),
    frequency_Hz = [...new Set(each_Hz)].sort((u, v) => u - v);
  const [a, b] = stages.map((stage) => stageValues(stage, frequency_Hz));
  const rows = figureRows({ ...b, ...a, frequency_Hz, objectives: { ...b.objectives, ...a.objectives } }).filter(
    ([, , key]) => hasFigure(a[key]) || hasFigure(b[key]),
  );
  const cell = (v, key, format) => el("td", { class: "number" }, shownFigure(key, v, format));
  const change = (u, v, format) => {
    if (typeof u !== "number" || typeof v !== "number" || u === v) return "";
    const size = decimalsOf(format(Math.abs(v - u)), [u, v].map(format));
    return size.startsWith("<") ? size : `${v > u ? "+" : "−"}${size}`;
  };
  section(
    "compare",
    "Comparison",
    el(
      "p",
      {},
      otherShape
        ? `The two results have the same net. The pictures can also show the shape of ${otherName}. The table of ` +
            "cables lists the tensions of both results."
        : "Because the two results have different nets, this page compares only their numerical results.",
    ),
    table(
      [
        ["Quantity"],
        [ofThis(stageName[stageA]), "number"],
        [ofOther(stageNames(other.summary)[stageB]), "number"],
        [`change to ${otherName}`, "number"],
        ["Unit"],
      ],
      rows.map(([name, unit, key, format]) =>
        el(
          "tr",
          {},
          quantity(name, unit, key),
          cell(a[key], key, format),
          cell(b[key], key, format),
          el("td", { class: "number" }, change(a[key], b[key], format)),
          el("td", { class: "unit" }, unit),
        ),
      ),
      `Figures of ${thisName} and ${otherName}`,
    ),
    ...caseDifferences(),
  );
}
