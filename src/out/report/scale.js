// Contents: colours, ticks.

// ---- colours ----

const darkScheme = matchMedia("(prefers-color-scheme: dark)");
const printing = matchMedia("print");
const isDark = () => darkScheme.matches && !printing.matches;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Colours that can be told apart with any kind of colour vision, in this order (tests/browser/look.mjs).
const SERIES = ["--one", "--two", "--three", "--four", "--five", "--six"];

// Converts OKLCH to sRGB bytes (Ottosson 2020), in which equal steps of lightness look equal.
function oklch(lightness, chroma, hue) {
  const a = chroma * Math.cos((hue * Math.PI) / 180),
    b = chroma * Math.sin((hue * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((v) => {
    const linear = Math.min(Math.max(v, 0), 1);
    return Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055));
  });
}

// Returns a colour for t = 0..1. Lightness changes evenly away from the background and hue from yellow to blue, so the
// colours can be told apart with any kind of colour vision.
function sequential(t) {
  return isDark()
    ? oklch(0.42 + 0.48 * t, 0.11 + 0.02 * t, 265 - 165 * t)
    : oklch(0.83 - 0.52 * t, 0.13, 95 + 170 * t);
}
// Returns a colour for signed values: t = 0.5 is zero, blue is below, orange is above. Both move away from the
// lightness of the background.
function diverging(t) {
  const size = Math.abs(2 * t - 1),
    hue = t < 0.5 ? 255 : 55;
  return isDark() ? oklch(0.3 + 0.48 * size, 0.15 * size, hue) : oklch(0.95 - 0.47 * size, 0.16 * size, hue);
}

// Smaller deviations are rounding. They have one colour and no scale.
const RESOLVED_MM = 1e-6;
const neutral = () => diverging(0.5);

// A mark or level is named instead of drawn when its distance from the values exceeds so many times their range.
const REACH = 2;

const LEVELS = 64;
const rgb = (c) => `rgb(${c[0]},${c[1]},${c[2]})`;
function levels(colours) {
  return Array.from({ length: LEVELS }, (_, k) => colours(k / (LEVELS - 1)));
}
function levelOf(value, [low, high]) {
  const t = high > low ? (value - low) / (high - low) : 0;
  return Math.max(0, Math.min(LEVELS - 1, Math.round(t * (LEVELS - 1))));
}

// Formats millimetres, or dB, for which the same limit of rounding is used.
const rounded = (v, digits) => (Math.abs(v) < RESOLVED_MM ? `< ${power(-6)}` : digitsOf(v, digits));
const roundedMm = (m) => (typeof m === "number" ? rounded(1e3 * m, 5) : "–");
// outer_mm: largest deviation of a node that psi does not count
const roundingNote = (outer_mm) =>
  el(
    "span",
    {},
    (outer_mm >= RESOLVED_MM
      ? `Nodes that ψ does not count are up to ${fmt(outer_mm)} mm away from their target positions. `
      : "") +
      "All inner nodes are within 1 nm of their target positions. Such deviations are rounding errors, so all nodes " +
      "have one neutral colour.",
  );

// Returns a range of colours for values low..high that hardly vary. It is at least SPREAD times the largest size, so
// that small differences do not look like large ones.
const SPREAD = 0.05;
function widened([low, high]) {
  const room = SPREAD * Math.max(Math.abs(low), Math.abs(high)) - (high - low);
  return room > 0 ? [low - room / 2, high + room / 2] : [low, high];
}

// Draws the colour bar of a picture. Values outside low..high, from `lowest` to `highest`, have the colours of its
// ends.
function drawBar(bar, colours, [low, high], label, [lowest, highest] = [low, high]) {
  const size = Math.max(Math.abs(low), Math.abs(high)),
    // enough digits to distinguish the ends
    digits = high > low ? Math.max(3, Math.ceil(Math.log10(size / (high - low))) + 2) : 3;
  const canvas = el("canvas", { width: 256, height: 1, role: "img", "aria-label": `colour bar: ${label}` });
  const c = canvas.getContext("2d");
  for (let x = 0; x < 256; x++) {
    c.fillStyle = rgb(colours(x / 255));
    c.fillRect(x, 0, 1, 1);
  }
  bar.replaceChildren(
    el("span", {}, label),
    el(
      "span",
      { class: "ramp" },
      canvas,
      el(
        "span",
        { class: "ticks" },
        [0, 0.5, 1].map((t) =>
          el(
            "span",
            {},
            (t === 0 && lowest < low ? "≤ " : "") +
              (t === 1 && highest > high ? "≥ " : "") +
              fmt(low + t * (high - low), digits),
          ),
        ),
      ),
    ),
  );
}

// ---- ticks ----

function linearTicks(low, high, wanted) {
  const raw = (high - low) / wanted,
    size = 10 ** Math.floor(Math.log10(raw));
  const step = size * [1, 2, 5, 10].find((k) => k * size >= raw * 0.999);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)),
    ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++)
    ticks.push({ at: k * step, text: decimals > 7 ? fmt(k * step, 6) : minus((k * step).toFixed(decimals)) });
  return ticks;
}

function logTicks(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-9),
    last = Math.floor(Math.log10(high) + 1e-9),
    ticks = [];
  const label = (v, e) => (e >= -3 && e <= 4 ? String(Number(v.toPrecision(3))) : power(e));
  if (last - first < 2) {
    for (let e = first - 1; e <= last; e++)
      for (const k of [1, 2, 5])
        if (k * 10 ** e >= low * 0.999 && k * 10 ** e <= high * 1.001)
          ticks.push({
            at: k * 10 ** e,
            text: k === 1 || e >= -3 ? label(k * 10 ** e, e) : `${k}×${power(e)}`,
          });
    return ticks.length > 1 ? ticks : linearTicks(low, high, 4);
  }
  const stride = Math.ceil((last - first + 1) / 7);
  for (let e = first; e <= last; e += stride) ticks.push({ at: 10 ** e, text: label(10 ** e, e) });
  return ticks;
}

// Returns an axis over the values. `at` maps a value to 0..1; all ticks are within that range.
function axis(values, log) {
  let [low, high] = range(log ? values.filter((v) => v > 0) : values) || [0, 1];
  if (log && low > 0) {
    const room = Math.max((high / low) ** 0.04, 1.05);
    low /= room;
    high *= room;
    return {
      low,
      high,
      ticks: logTicks(low, high),
      at: (v) => Math.log(v / low) / Math.log(high / low),
      has: (v) => v > 0,
    };
  }
  const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
  const room = high - low > 1e-6 * size ? 0.05 * (high - low) : 0.05 * size; // a smaller range is rounding
  low -= room;
  high += room;
  return { low, high, ticks: linearTicks(low, high, 5), at: (v) => (v - low) / (high - low), has: () => true };
}
