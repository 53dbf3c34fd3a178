// The section of the far field of surface.pattern: cuts, and the figures of each.

// Returns the far fields of this result, and that of the result of the other file.
function patterns() {
  const named = (list, name) => (list || []).map((p) => ({ ...p, name: name(p) }));
  const stage = other && resultStageIn(other.summary, (of) => other.summary[of]),
    theirs = other && (other.pattern || []).filter((p) => p.stage === stage);
  return [
    ...named(data.pattern, (p) => ofThis(stageName[p.stage])),
    ...named(theirs, (p) => ofOther(stageNames(other.summary)[p.stage])),
  ];
}

const phi = (angle) => `φ ${fmt(angle, 6)}°`,
  angles = (list) => (list.length > 1 ? `${phi(list[0])} to ${fmt(list.at(-1), 6)}°` : phi(list[0]));
const different = (values) => [...new Set(values)].sort((a, b) => a - b);

const CUTS_MAX = 4, // not more than there are colours
  DASHES = ["7 3", "2 3", "9 3 2 3"],
  DEPTH_DB = 60; // range below the beam

// Draws the cuts of one frequency, at most CUTS_MAX of them. Each cut has a colour, and each shape other than the
// result has a dash.
//   isPart: other charts show further cuts
function patternChart(all, frequency_Hz, phi_deg, isPart) {
  const x = different(all.flatMap((p) => p.theta_deg)),
    at = new Map(x.map((theta, i) => [theta, i]));
  const shapes = all.map((p) => ({ ...p, isResult: p.name === resultShape.name }));
  const dashed = shapes.filter((p) => !p.isResult);
  const series = shapes.flatMap((p) =>
    [...p.cut]
      .sort((a, b) => a.phi_deg - b.phi_deg)
      .filter((cut) => cut.frequency_Hz === frequency_Hz && phi_deg.includes(cut.phi_deg))
      .map((cut) => {
        const values = Array(x.length).fill(undefined);
        cut.co_dBi.forEach((v, i) => (values[at.get(p.theta_deg[i])] = v));
        return {
          name: all.length > 1 ? `${phi(cut.phi_deg)}, ${p.name}` : phi(cut.phi_deg),
          stored: "co_dBi",
          values,
          colour: SERIES[phi_deg.indexOf(cut.phi_deg)],
          dash: p.isResult ? null : DASHES[dashed.indexOf(p) % DASHES.length],
        };
      }),
  );
  const most = range(series.flatMap((s) => s.values));
  return (
    most &&
    chart({
      title: `${fmt(frequency_Hz / 1e9, 6)} GHz${isPart ? `, ${angles(phi_deg)}` : ""}`,
      xLabel: "θ (°)",
      yLabel: "gain (dBi)",
      unit: "dBi",
      x,
      counted: false,
      log: false,
      floor: most[1] - DEPTH_DB,
      head: (i) => `θ ${fmt(x[i], 5)}°`,
      series,
    })
  );
}

function patternTable(all) {
  const rows = all
    .flatMap((p) => p.cut.map((cut) => ({ ...cut, name: p.name })))
    .sort((a, b) => a.frequency_Hz - b.frequency_Hz || a.phi_deg - b.phi_deg);
  const number = (name, key, decimals, unit = 1) => ({
    name,
    number: true,
    of: (i) => rows[i][key],
    show: (i) => (typeof rows[i][key] === "number" ? minus((rows[i][key] / unit).toFixed(decimals)) : "–"),
  });
  const plain = (name, key, unit = 1) => ({
    ...number(name, key, 0),
    show: (i) => fmt(rows[i][key] / unit, 6),
  });
  return sortableTable({
    caption: "Figures of the cuts",
    columns: [
      plain("frequency (GHz)", "frequency_Hz", 1e9),
      plain("cut φ (°)", "phi_deg"),
      { name: "shape", of: (i) => rows[i].name, show: (i) => rows[i].name.replace(/ /g, "\u00a0") },
      number("gain (dBi)", "gain_dBi", 3),
      number("beam at θ (°)", "beam_deg", 4),
      number("half-power width (°)", "half_power_width_deg", 4),
      number("first sidelobe (dB)", "first_sidelobe_dB", 2),
      number("highest sidelobe (dB)", "highest_sidelobe_dB", 2),
      number("cross-polarised (dB)", "cross_dB", 2),
    ],
    n: rows.length,
    by: -1,
  });
}

const FEED = { point: "a point", line: "a line", plane_wave: "a plane wave" };

function patternText(all) {
  const { feed, cos_power: power, stride } = all[0],
    cosine = `power ${fmt(power, 3)} of the cosine of the angle from its axis`,
    field = feed === "plane_wave" ? "" : ` whose field is proportional to ${cosine}`;
  return (
    "The charts show the far field of the facets, computed by physical optics. " +
    `The feed is ${FEED[feed] || feed}${field}. The gain is relative to isotropic radiation, in the polarisation of ` +
    "the feed. θ is the angle from +z. Each cut is the half plane at the angle φ from +x towards +y." +
    (stride > 1 ? ` Each plotted value is the maximum gain over ${stride} neighbouring angles.` : "")
  );
}

const PATTERN_NOTE =
  "Sidelobe levels and cross-polarisation levels are relative to the maximum of the beam. " +
  "A dash (–) means that the angle range of the cut is too small or the angle spacing is too coarse.";

function writePattern() {
  const all = patterns();
  if (!all.length) return;
  const cuts = all.flatMap((p) => p.cut),
    list = different(cuts.map((cut) => cut.phi_deg)),
    groups = Array.from({ length: Math.ceil(list.length / CUTS_MAX) }, (_, k) =>
      list.slice(CUTS_MAX * k, CUTS_MAX * (k + 1)),
    );
  const charts = different(cuts.map((cut) => cut.frequency_Hz)).flatMap((frequency_Hz) =>
    groups.map((group) => patternChart(all, frequency_Hz, group, groups.length > 1)),
  );
  section(
    "far-field",
    "Far field",
    el("p", {}, patternText(all)),
    el("div", { class: "charts wide" }, charts.filter((c) => c)),
    el("h3", { class: "after" }, "Beam and sidelobes"),
    patternTable(all).node,
    el("p", { class: "muted" }, PATTERN_NOTE),
  );
}
