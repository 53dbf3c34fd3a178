// Contents: tooltips, one chart.

// ---- tooltips: a heading, and rows of name, value and the name in the file ----

function tipContent(heading, rows) {
  return [
    el("strong", {}, heading),
    el(
      "table",
      {},
      rows.map(([name, value, stored]) =>
        el(
          "tr",
          {},
          el("th", { scope: "row" }, name),
          el("td", {}, value),
          el("td", {}, stored ? el("code", {}, stored) : ""),
        ),
      ),
    ),
  ];
}

// Shows the tooltip beside the point (x, y) of its parent, inside the parent.
function placeTip(tip, x, y, content) {
  tip.replaceChildren(...content);
  tip.hidden = false;
  const width = tip.parentElement.clientWidth,
    height = tip.parentElement.clientHeight;
  const right = x + 14 + tip.offsetWidth <= width,
    below = y + 14 + tip.offsetHeight <= height;
  tip.style.left = `${right ? x + 14 : Math.max(0, x - 14 - tip.offsetWidth)}px`;
  tip.style.top = `${below ? y + 14 : Math.max(0, y - 14 - tip.offsetHeight)}px`;
}

// ---- one chart: series over x with a cursor that follows the pointer or the arrow keys ----
// series: { name, stored, values, colour, dash, dots: marks instead of a line, free: may lie outside the picture }
//   isLevel: the same value everywhere, drawn without marks; size: of its marks, in pixels
//   isWide: drawn as a band, below the series that follow
//   isMarked: its line has marks, however many points there are
//   bars: half the width of a bar around each x, which begins at 0
//   errors: for each x the ends of an error bar, [low, high], or null
// marks: { name, at, colour, dash } of vertical lines, or with level instead of at of horizontal ones; the axes include
//   them
// colour: a variable of the page's style, or a function that returns red, green and blue
// floor: lower limit of the axis; smaller values are outside the picture
// x ascends; counted: x are whole numbers; log: "auto" is logarithmic when the values span a factor above 20
let clips = 0;
const paint = (colour) => (typeof colour === "function" ? rgb(colour()) : `var(${colour})`);
const LINES_MAX = 12, // lines of a tooltip
  MARKED_MAX = 16; // a curve with at most so many points gets marks on its line

function chart(options) {
  const { title, caption, xLabel, yLabel, unit = "", x, series, marks = [], counted = true, head, floor } = options;
  let { log = "auto" } = options;
  const shownOf = (s) => (floor === undefined ? s.values : s.values.map((v) => (v < floor ? floor : v))),
    upright = marks.filter((m) => m.level === undefined),
    levels = marks.filter((m) => m.level !== undefined),
    leading = series
      .filter((s) => !s.free)
      .flatMap((s) => (s.bars === undefined ? [...shownOf(s), ...(s.errors || []).flat()] : [0, ...s.values]))
      .concat(levels.map((m) => m.level)),
    positive = range(leading.filter((v) => v > 0));
  const clip = `clip-${++clips}`;
  if (!range(leading) && !leading.includes(Infinity)) return null; // nothing to draw
  if (log === "auto") log = !!positive && positive[1] > 20 * positive[0];
  const margin = { left: 64, right: 14, top: 26, bottom: 42 },
    height = 290;
  const holder = el("div", { class: "stage chart-stage", style: "border:0;background:none;margin-top:.3rem" });
  const picture = svg("svg", {
    role: "img",
    tabindex: 0,
    "aria-label": `${title}: ${yLabel} against ${xLabel}. Press the left and right arrow keys to read the values.`,
  });
  const tip = el("div", { class: "tip", role: "status", hidden: true });
  let cursor = -1,
    place;

  const markLine = (m, ends) =>
    svg("line", { class: "curve", ...ends, "stroke-dasharray": m.dash, style: `stroke:${paint(m.colour)}` });

  function mark(s) {
    return s.dots
      ? { class: "dots", "stroke-width": s.size || (s.values.length > 300 ? 3 : 5) }
      : { class: s.isWide ? "curve wide" : "curve", "stroke-dasharray": s.dash };
  }

  function bars(s, sx, sy) {
    const edge = (v) => sx(v).toFixed(1),
      text = s.values.map((v, i) => `V${sy(v).toFixed(1)}H${edge(x[i] + s.bars)}`).join("");
    const d = `M${edge(x[0] - s.bars)} ${sy(0).toFixed(1)}${text}V${sy(0).toFixed(1)}`;
    return svg("path", { d, class: "curve bars", style: `stroke:${paint(s.colour)};fill:${paint(s.colour)}` });
  }

  function path(s, sx, sy, yAxis) {
    if (s.bars !== undefined) return bars(s, sx, sy);
    let text = "",
      on = false;
    s.values.forEach((v, i) => {
      if (v === undefined) return; // the series has no point here: its line continues
      const good = Number.isFinite(v) && yAxis.has(v);
      if (good) text += `${on && !s.dots ? "L" : "M"}${sx(x[i]).toFixed(1)} ${sy(v).toFixed(1)}${s.dots ? "h0" : ""}`;
      on = good;
    });
    const line = svg("path", { d: text, ...mark(s), style: `stroke:${paint(s.colour)}` });
    const isBare = s.dots || s.isLevel || (x.length > MARKED_MAX && !s.isMarked);
    return isBare ? line : [line, path({ ...s, dots: true }, sx, sy, yAxis)];
  }

  // Draws error bars: vertical lines with a short line at each end.
  function errorBars(s, sx, sy, yAxis) {
    const d = (s.errors || []).map((ends, i) => {
      if (!ends || ends[0] === ends[1] || !ends.every((v) => Number.isFinite(v) && yAxis.has(v))) return "";
      const [low, high] = ends.map((v) => sy(v).toFixed(1)),
        cap = (y) => `M${(sx(x[i]) - 4).toFixed(1)} ${y}h8`;
      return `M${sx(x[i]).toFixed(1)} ${low}V${high}${cap(low)}${cap(high)}`;
    });
    return s.errors ? [svg("path", { d: d.join(""), class: "curve", style: `stroke:${paint(s.colour)}` })] : [];
  }

  // Draws infinite values at the upper edge of the picture, with one sign for each run of neighbours.
  function endless(s, sx) {
    const marks = s.values.flatMap((v, i) =>
      v === Infinity ? svg("circle", { cx: sx(x[i]), cy: margin.top, r: 3, style: `fill:${paint(s.colour)}` }) : [],
    );
    const signs = s.values.flatMap((v, i) =>
      v === Infinity && s.values[i - 1] !== Infinity
        ? svg("text", { class: "label", x: sx(x[i]) - 3, y: margin.top + 17, "text-anchor": "start" }, "∞")
        : [],
    );
    return [...marks, ...signs];
  }

  function draw() {
    const width = Math.max(holder.clientWidth, 260),
      yAxis = axis(leading, log);
    if (!range(leading)) yAxis.ticks = []; // no finite value, so no ticks
    margin.left = 16 + 7 * Math.max(4, ...yAxis.ticks.map((t) => t.text.length));
    const w = width - margin.left - margin.right;
    const h = height - margin.top - margin.bottom;
    const half = Math.max(0, ...series.map((s) => s.bars || 0)),
      ends = range([x[0] - half, x[x.length - 1] + half, ...upright.map((m) => m.at)]),
      xAxis = { low: ends[0], high: ends[1] };
    if (xAxis.high === xAxis.low) {
      xAxis.low -= 1;
      xAxis.high += 1;
    }
    const sx = (v) => margin.left + (w * (v - xAxis.low)) / (xAxis.high - xAxis.low);
    const sy = (v) => margin.top + h * (1 - yAxis.at(v));
    place = { sx, sy, yAxis, bottom: margin.top + h };
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    // as many ticks as have room for their labels
    let wanted = Math.max(4, w / 64),
      xTicks;
    do {
      xTicks = linearTicks(xAxis.low, xAxis.high, wanted)
        .filter((t) => !counted || Number.isInteger(t.at))
        .map((t) => ({ at: t.at, text: counted ? minus(String(t.at)) : t.text }));
      wanted *= 0.7;
    } while (xTicks.length > 2 && xTicks.length * (7 * Math.max(...xTicks.map((t) => t.text.length)) + 16) > w);
    picture.replaceChildren();
    fill(picture, {}, [
      ...yAxis.ticks.flatMap((t) => [
        svg("line", { class: "grid", x1: margin.left, x2: margin.left + w, y1: sy(t.at), y2: sy(t.at) }),
        svg("text", { x: margin.left - 7, y: sy(t.at) + 4, "text-anchor": "end" }, t.text),
      ]),
      ...xTicks.flatMap((t) => [
        svg("line", {
          class: "frame",
          x1: sx(t.at),
          x2: sx(t.at),
          y1: margin.top + h,
          y2: margin.top + h + 4,
        }),
        svg("text", { x: sx(t.at), y: margin.top + h + 18, "text-anchor": "middle" }, t.text),
      ]),
      svg("line", {
        class: "frame",
        x1: margin.left,
        x2: margin.left + w,
        y1: margin.top + h,
        y2: margin.top + h,
      }),
      svg("text", { class: "label", x: margin.left + w / 2, y: height - 4, "text-anchor": "middle" }, xLabel),
      svg("text", { class: "label", x: 2, y: 13 }, yLabel),
      svg("clipPath", { id: clip }, svg("rect", { x: margin.left - 4, y: margin.top, width: w + 8, height: h })),
      svg(
        "g",
        { "clip-path": `url(#${clip})` },
        series.flatMap((s) => [path(s, sx, sy, yAxis), errorBars(s, sx, sy, yAxis)].flat()),
      ),
      ...upright.map((m) => markLine(m, { x1: sx(m.at), x2: sx(m.at), y1: margin.top, y2: margin.top + h })),
      ...levels.map((m) => markLine(m, { x1: margin.left, x2: margin.left + w, y1: sy(m.level), y2: sy(m.level) })),
      ...series.flatMap((s) => endless(s, sx)),
      svg("g", { class: "at" }),
    ]);
    point(cursor);
  }

  const isInside = (at) => at >= 0 && at <= 1;
  function point(i) {
    cursor = i;
    const group = picture.querySelector(".at");
    group.replaceChildren();
    if (i < 0) {
      tip.hidden = true;
      return;
    }
    const px = place.sx(x[i]),
      here = series.filter((s) => typeof s.values[i] === "number");
    const shown = here.filter(
      (s) => Number.isFinite(s.values[i]) && place.yAxis.has(s.values[i]) && isInside(place.yAxis.at(s.values[i])),
    );
    fill(group, {}, [
      svg("line", { class: "cursor", x1: px, x2: px, y1: margin.top, y2: place.bottom }),
      ...shown.map((s) =>
        svg("circle", { cx: px, cy: place.sy(s.values[i]), r: 4, style: `fill:${paint(s.colour)}` }),
      ),
    ]);
    placeTip(
      tip,
      px,
      shown.length ? place.sy(shown[0].values[i]) : margin.top,
      tipContent(
        head(i),
        here.slice(0, LINES_MAX).map((s) => {
          const ends = s.errors && s.errors[i] ? ` (${s.errors[i].map((v) => fmt(v, 6)).join(" to ")})` : "";
          return [s.name, `${fmt(s.values[i], 6)} ${unit}${ends}`, s.stored];
        }),
      ),
    );
  }

  const nearest = (px) => {
    let best = 0;
    for (let i = 1; i < x.length; i++) if (Math.abs(place.sx(x[i]) - px) < Math.abs(place.sx(x[best]) - px)) best = i;
    return best;
  };
  picture.addEventListener("pointermove", (event) =>
    point(nearest(event.clientX - picture.getBoundingClientRect().left)),
  );
  picture.addEventListener("pointerleave", () => point(-1));
  picture.addEventListener("blur", () => point(-1));
  picture.addEventListener("keydown", (event) => {
    const last = x.length - 1;
    const to = {
      ArrowLeft: Math.max(0, cursor - 1),
      ArrowRight: Math.min(last, cursor + 1),
      Home: 0,
      End: last,
      Escape: -1,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    point(to);
  });
  new ResizeObserver(draw).observe(holder);
  darkScheme.addEventListener("change", draw);
  printing.addEventListener("change", draw);
  holder.append(picture, tip);

  const legend =
    series.length + marks.length < 2
      ? null
      : el(
          "div",
          { class: "legend" },
          [...series, ...marks].map((s) =>
            el(
              "span",
              {},
              svg(
                "svg",
                { viewBox: "0 0 26 10", "aria-hidden": "true" },
                svg("path", {
                  d: s.dots ? "M13 5h0" : "M0 5H26",
                  ...mark(s),
                  style: `stroke:${paint(s.colour)}`,
                }),
              ),
              s.name,
            ),
          ),
        );
  return el(
    "figure",
    { class: "chart" },
    el("h3", {}, title),
    legend,
    holder,
    caption ? el("figcaption", {}, caption) : null,
  );
}
