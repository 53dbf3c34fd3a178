// Parts of a page that only some results have.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { csv, DATA, number, openCopy, picture, same, settle, tip } from "./see.mjs";

// Nodes whose deviations are rounding have one colour, and the page says so, and how far those are that psi does not
// count; another shape of the page has a scale. Of the two nets in space only the front counts.
export async function checkRounding(tab, made) {
  const away = ({ x_m, y_m, z_m, x0_m, y0_m, z0_m }) => 1e3 * Math.hypot(x_m - x0_m, y_m - y0_m, z_m - z0_m),
    outer_mm = Math.max(0, ...made.nodes.filter(({ role }) => role !== "inner").map(away));
  for (const name of ["rear", "rear edge", "tie"])
    await tab.locator("#families").getByLabel(name, { exact: true }).uncheck();
  for (const [part, canvas] of [
    ["#net", "net-canvas"],
    ["#map", "map-canvas"],
  ]) {
    const bar = tab.locator(`${part} .bar`),
      colours = async (name) => {
        await tab.locator(part).getByLabel(name, { exact: true }).check();
        if (part === "#net") await tab.locator(part).getByLabel("deviation", { exact: true }).check();
        return (await picture(tab, canvas)).colours;
      };
    const one = await colours("refine"),
      told = (await bar.innerText()).match(/^Nodes that ψ does not count are up to (\S+) mm away/);
    assert.equal(await bar.locator("canvas").count(), 0, "a scale of rounding");
    if (part === "#net" && outer_mm >= 1e-6) same(number(told[1]), outer_mm, 4);
    assert.match(await bar.innerText(), /within 1 nm of their target positions.* one neutral colour\.$/);
    const many = await colours("form");
    assert.ok(!(await bar.innerText()).includes("1 nm"));
    assert.ok(many > one + 20, `${part}: ${one} colours of rounding, ${many} of deviations`);
  }
  await tab.reload();
}

// Every line of the far field has the values of the exported table, of neighbouring angles the highest; the table of
// cuts has the figures of the summary.
export async function checkPattern(tab, page, made) {
  const { charts, neighbours } = page.pattern,
    stages = { form: "form", refine: "refine" };
  assert.equal(await tab.locator("#far-field .chart").count(), charts);
  const { width } = await tab.locator("#far-field .chart").first().boundingBox();
  assert.ok(width > 900, "a pattern has the whole width");
  assert.equal(await tab.locator("#far-field h3").nth(1).textContent(), "2 GHz, φ 135°");
  const cells = await tab
      .locator("#far-field tbody tr")
      .evaluateAll((all) => all.map((row) => [...row.children].map((c) => c.textContent))),
    figures = Object.keys(stages).flatMap((stage) => made.summary[stage].pattern.map((cut) => ({ ...cut, stage })));
  figures.sort((a, b) => a.frequency_Hz - b.frequency_Hz || a.phi_deg - b.phi_deg);
  assert.equal(cells.length, figures.length);
  assert.ok(figures.some((cut) => cut.half_power_width_deg === null));
  figures.forEach((cut, k) => {
    const [frequency, phi, shape, gain, beam, ...rest] = cells[k];
    assert.deepEqual(
      [number(frequency), number(phi), shape],
      [cut.frequency_Hz / 1e9, cut.phi_deg, stages[cut.stage].replace(" ", "\u00a0")],
    );
    assert.ok(Math.abs(number(gain) - cut.gain_dBi) < 6e-4 && Math.abs(number(beam) - cut.beam_deg) < 6e-5);
    [cut.half_power_width_deg, cut.first_sidelobe_dB, cut.highest_sidelobe_dB].forEach((v, c) =>
      v === null ? assert.equal(rest[c], "–") : assert.ok(Math.abs(number(rest[c]) - v) < 6e-3),
    );
  });
  const picture = tab.locator("#far-field .chart").first(),
    at = 401; // near the beam
  assert.match(await picture.locator(".legend").innerText(), /φ 0°, form/);
  await picture.locator("svg[tabindex]").focus();
  for (let i = 0; i <= at; i++) await tab.keyboard.press("ArrowRight");
  await settle(tab);
  const said = await picture.locator(".tip tr").evaluateAll((all) => all.map((r) => r.innerText.split("\t")));
  assert.equal(said.length, 8);
  for (const [stage, name] of Object.entries(stages)) {
    made.hifdm("export", "result.h5", "--pattern", "pattern.csv", "--stage", stage, "--force");
    const table = csv(join(made.folder, "pattern.csv")).filter((row) => row.frequency_Hz === "2000000000");
    for (const phi of [0, 20, 45, 90]) {
      const cut = table.filter((row) => Number(row.phi_deg) === phi),
        near = cut.slice(neighbours * at, neighbours * (at + 1)).map((row) => Number(row.co_dBi)),
        [, shown] = said.find(([heading]) => heading === `φ ${phi}°, ${name}`);
      same(number(shown), Math.max(...near), 5);
    }
  }
  await tab.keyboard.press("Escape");
}

// The adjustments are those of the workshop's table; the chart has the figure after each, the picture their cables.
export async function checkAdjust(tab, made, changes) {
  const adjustments = csv(join(made.folder, "adjustments.csv")),
    rows = tab.locator("#adjust tbody tr");
  assert.ok(adjustments.length > 3 && (await rows.count()) === adjustments.length);
  const cells = await rows.evaluateAll((all) => all.map((row) => [...row.children].map((c) => c.textContent)));
  assert.deepEqual(
    cells.map(([order, cable]) => [order, cable]),
    adjustments.map(({ order, cable }) => [order, cable]),
  );
  for (const [column, key] of [
    [2, "turnbuckle_mm"],
    [4, "tension_before_N"],
    [5, "tension_after_N"],
    [6, "predicted_rms_mm"],
  ]) {
    const wanted = adjustments.map((row) => Number(row[key])),
      most = Math.max(...wanted.map(Math.abs));
    cells.forEach((row, k) => assert.ok(Math.abs(number(row[column]) - wanted[k]) < 6e-4 * most, `${key}: ${row}`));
  }
  await tab.locator("#adjust svg[tabindex]").focus();
  await tab.keyboard.press("End");
  const said = await tab.locator("#adjust .tip").innerText(),
    last = adjustments.at(-1);
  assert.ok(said.startsWith(`adjustment ${adjustments.length}: cable ${last.cable}`));
  same(number(said.match(/predicted\s+([\d.]+)/)[1]), Number(last.predicted_rms_mm), 6);
  await tab.keyboard.press("Escape");
  const bar = await tab.locator("#net .bar").innerText();
  assert.match(bar, new RegExp(`^${adjustments.length} of .* have a turnbuckle adjustment$`));
  await checkWorkshop(tab, made);
  await changes(tab, "a name of an adjustment", () => rows.first().getByRole("button").click());
  assert.equal((await tip(tab, "net")).heading, `cable ${adjustments[0].cable}`);
  assert.ok(Math.abs(number((await tip(tab, "net"))["turnbuckle adjustment"]) - adjustments[0].turnbuckle_mm) < 1e-9);
  const deviation = tab.locator("#net").getByLabel("deviation", { exact: true });
  await changes(tab, "the colour of adjustments", () => deviation.check());
  await tab.reload();
}

// Only the table of adjustments, named for the workshop, has signed lengths or steps. Those of other tables have words
// for their direction, and differences of designs are not on this page.
async function checkWorkshop(tab, made) {
  const name = "Turnbuckle adjustments for the workshop, in their order",
    heads = async (place) => (await tab.locator(`${place} thead th`).allTextContents()).map((text) => text.trim());
  assert.equal(await tab.locator("#adjust h3.after").first().textContent(), name);
  const [, , move, steps, ...rest] = await heads("#adjust");
  assert.deepEqual([move, steps], ["turnbuckle adjustment (mm)", "turnbuckle adjustment (steps)"]);
  assert.ok(
    rest.every((head) => /(ψ|tension|gain|slack).*/.test(head)),
    rest.join("; "),
  );
  for (const table of await tab.locator("main table[aria-label]").all()) {
    const signed = (await table.locator("td").allTextContents()).some((text) => /^[+−]\d/.test(text)),
      caption = await table.getAttribute("aria-label");
    if (signed) assert.equal(caption, name, `${caption} has signed values`);
  }
  const cables = await heads("#cables");
  assert.ok(!cables.some((head) => /^unstressed:|per mm|turn/.test(head)), cables.join("; "));
  assert.match(await tab.locator("#cables > p").textContent(), /not turnbuckle adjustments\. The workshop follows/);
  const column = cables.indexOf("estimated length error (mm)"),
    rows = await tab
      .locator("#cables tbody tr")
      .evaluateAll((all) => all.map((r) => [...r.children].map((c) => c.textContent))),
    errors_m = await tab.evaluate(() => Array.from(data.adjust.error_m)),
    ids = new Map(made.cables.map(({ id }, e) => [id, e]));
  for (const cells of rows) {
    const error_m = errors_m[ids.get(cells[0])],
      [, size, direction] = cells[column].match(/^([\d.]+) too (long|short)$/);
    assert.equal(direction, error_m > 0 ? "long" : "short");
    assert.ok(
      Math.abs(number(size) - 1e3 * Math.abs(error_m)) < 6e-3 * Math.max(...errors_m.map((v) => 1e3 * Math.abs(v))),
    );
  }
}

// Terms, and those figures of the summary that `hifdm explain` knows, in its words.
export async function checkWords(tab, made) {
  await tab.locator("#summary details summary").click();
  const words = await tab
    .locator("#summary dt")
    .evaluateAll((all) =>
      all.map((dt) => [dt.textContent.replaceAll("\u200b", ""), dt.nextElementSibling.textContent]),
    );
  assert.ok(words.length > 30 && new Set(words.map(([word]) => word)).size === words.length);
  const said = (text) => text.replace(/\s+/g, " ");
  for (const word of ["psi", "law", "residual_N", "position_bound_m"]) {
    const [, text] = words.find(([name]) => name === word);
    assert.ok(said(made.hifdm("explain", word)).includes(said(text)), `${word}: ${text}`);
  }
  assert.ok(!words.some(([word]) => word === "facet_half_path_rms_m"), "a figure that is not there is explained");
  await tab.locator("#summary details summary").click();
}

// The rows of requirements are those of the file, the failed and the tightest first and the others behind a button;
// the distribution function of a row reaches its yield at its bound, that of the worst if there are several load cases.
export async function checkRequirements(tab, made) {
  const { requirements, verdict } = made.summary,
    rank = ["fail", "undecided", "pass"],
    margin = (row) => row.relative_margin ?? Infinity,
    sorted = requirements
      .slice()
      .sort((a, b) => rank.indexOf(a.verdict) - rank.indexOf(b.verdict) || margin(a) - margin(b) || 0),
    open = sorted.filter((row) => rank.indexOf(row.verdict) < 2).length;
  assert.ok(open > 0 && sorted.length > open + 5);
  assert.equal(await tab.locator("#requirements h2").textContent(), `Verdict: ${verdict}`);
  const first = tab.locator("main > :not(noscript)").first();
  assert.equal(await first.getAttribute("id"), "requirements", "the verdict comes first");
  const rows = tab.locator("#requirements tbody tr");
  assert.equal(await rows.count(), open + 5);
  await tab.locator("#requirements .tools button").click();
  assert.equal(await rows.count(), sorted.length);
  const cells = await rows.evaluateAll((all) => all.map((row) => [...row.children].map((c) => c.textContent)));
  sorted.forEach((row, k) => {
    const [name, word, value, , size, relative, met] = cells[k],
      times = row.unit === "m" ? 1e3 : 1;
    assert.ok(name.startsWith(row.figure) && word === (row.verdict === "none" ? "–" : row.verdict), cells[k]);
    same(number(value), times * row.value, 4);
    same(number(size), times * row.margin, 4);
    if (row.relative_margin !== null) same(number(relative), 100 * row.relative_margin, 3);
    if (row.yield !== null) same(number(met), 100 * row.yield, 4);
  });
  await tab.locator("#requirements .tools button").click();
  const at = await tab.evaluate(() =>
    data.required.map(({ curves }, i) =>
      curves.map((c) => [c.load_case, shareBelow(c, summary.requirements[i].at_most), c.value.length]),
    ),
  );
  requirements.forEach((row, i) => {
    const states = row.load_case === "all" ? 3 : 1, // two and the worst of them
      ends = row.figure === "tension" && row.at_least !== null && row.at_most !== null ? 2 : 1;
    assert.equal(at[i].length, row.share === null ? 0 : states * ends, `curves of ${row.figure}`);
    if (row.share === null || ends > 1 || row.at_most === null) return;
    const [state, share, n] = at[i].at(-1);
    assert.equal(state, row.load_case);
    assert.ok(n === 400 && Math.abs(share - 100 * row.yield) < 100 / 400, `${at[i]}: ${row.yield}`);
  });
  await checkWorst(tab, made);
  await checkTensions(tab, made);
  await checkCostly(tab, made);
  assert.equal(await tab.locator("#distributions .chart").count(), 4);
  await tab.locator("#distributions button").click();
  const shown = await tab.locator("#distributions .chart h3").allTextContents();
  assert.deepEqual(
    shown.map((name) => name.split(/[ ,]/)[0]),
    sorted.filter((row) => row.share !== null).map((row) => row.figure),
  );
  await tab.reload();
}

// The curve of all load cases has the worst value of each sample. The charts have horizontal lines at the required
// shares, and the legend explains both.
async function checkWorst(tab, made) {
  for (const [name, stored, worse, bound, level, words] of [
    ["psi, all", "psi", Math.max, "at_most", 95, "at least 95 % of the samples at most 80 mm"],
    ["tension of inner, all", "tension_min_inner", Math.min, "at_least", 5, "at most 5 % of the samples below 4 N"],
    ["tension of inner, all", "tension_max_inner", Math.max, "at_most", 95, "at least 95 % of the samples at most 60"],
  ]) {
    const of = (state) => samplesOf(made, `/tolerance/load_case/${state}/${stored}`, false),
      [nominal, cold] = ["nominal", "cold"].map(of),
      worst = nominal.map((v, i) => worse(v, cold[i])).sort((a, b) => a - b),
      [value, share] = await tab.evaluate(
        ([begin, side]) => {
          const row = data.required.find((r) => r.name.startsWith(begin)),
            curve = row.curves.find((c) => c.load_case === "all" && c.bound === side);
          return [Array.from(curve.value), Array.from(curve.share)];
        },
        [name, bound],
      );
    value.forEach((v, k) => same(v, worst[Math.round(share[k] * worst.length) - 1], 6));
    const drawn = tab.locator("#distributions .chart", { has: tab.locator("h3", { hasText: name }) }),
      legend = (await drawn.locator(".legend").innerText()).replaceAll("\u00a0", " ");
    assert.match(legend, /worst of all load cases in each sample/);
    const levels = await drawn.locator("svg[tabindex]").evaluate((picture) => {
      const texts = [...picture.querySelectorAll("text[text-anchor=end]")],
        [none, all] = ["0", "100"].map((text) => texts.find((t) => t.textContent === text).getAttribute("y") - 4);
      return [...picture.querySelectorAll("line.curve")]
        .filter((line) => line.getAttribute("y1") === line.getAttribute("y2"))
        .map((line) => (100 * (line.getAttribute("y1") - none)) / (all - none));
    });
    assert.ok(legend.includes(`required: ${words}`), legend);
    assert.ok(
      levels.some((at) => Math.abs(at - level) < 0.01),
      `lines at ${levels}`,
    );
  }
  const one = tab.locator("#distributions .chart", { has: tab.locator("h3", { hasText: "psi, 90" }) });
  assert.ok(!(await one.locator(".legend").innerText()).includes("worst"), "the worst of one load case");
}

// Each set has a row in each load case: its tensions, those of the samples, the tightest required bounds, and a picture
// with a mark at each of them.
async function checkTensions(tab, made) {
  const cells = await tab
      .locator("#tensions tbody tr")
      .evaluateAll((all) => all.map((row) => [...row.children].map((c) => c.textContent))),
    stored = made.summary.requirements.filter((row) => row.figure === "tension");
  const ofShape = await tab.evaluate(() =>
    Object.fromEntries(data.shapes.map((s) => [s.load_case || "nominal", Array.from(s.tension_N)])),
  );
  assert.deepEqual(Object.keys(ofShape), ["nominal", "cold"]);
  for (const set of ["inner", "boundary"])
    for (const [state, tension_N] of Object.entries(ofShape)) {
      const [, , least, most, few, many, required] = cells.find(([a, b]) => a === set && b === state),
        own = tension_N.filter((_, e) => made.cables[e].group === set),
        rows = stored.filter((row) => row.set === set && ["all", state].includes(row.load_case));
      same(number(least), Math.min(...own), 4);
      same(number(most), Math.max(...own), 4);
      const low = Math.max(...rows.map((row) => row.at_least ?? -Infinity)),
        high = Math.min(...rows.map((row) => row.at_most ?? Infinity)),
        text = low > -Infinity ? `${low} to ${high}` : high < Infinity ? `≤ ${high}` : "–";
      assert.equal(required, text);
      for (const [shown, is_minimum, part] of [
        [few, true, 0.05],
        [many, false, 0.95],
      ]) {
        const name = `/tolerance/load_case/${state}/tension_${is_minimum ? "min" : "max"}_${set}`,
          samples = samplesOf(made, name);
        if (!samples) assert.equal(shown, "–", name);
        else same(number(shown), samples[Math.ceil(part * samples.length) - 1], 2); // the page has 400 of 600
      }
    }
  const row = tab.locator("#tensions tbody tr", { hasText: "inner" }).first();
  assert.equal(await row.locator("svg .bound").count(), 2);
  assert.equal(await row.locator("svg .tensions").count(), 1);
}

// The tolerances are those of the requirement with the lowest yield, which is not that of psi: named in the heading,
// its bars add up to all samples, and those beyond its bound to those that fail.
async function checkCostly(tab, made) {
  const rows = made.summary.requirements.map((row, i) => ({ ...row, i })).filter((row) => row.yield !== null),
    least = rows.reduce((a, b) => (a.yield <= b.yield ? a : b)),
    name = await tab.evaluate((i) => data.required[i].name, least.i);
  assert.ok(least.figure !== "psi" && rows.some((row) => row.figure === "psi" && row.yield < 1));
  assert.equal(await tab.locator("#tolerance h2").textContent(), `Tolerances: ${name}`);
  const mark = await tab.locator("#tolerance .legend").innerText();
  assert.ok(mark.includes(`at least ${least.at_least}`), mark);
  assert.equal(await tab.locator("#tolerance .chart h3").textContent(), "Samples in load case cold"); // worse of two
  const picture = tab.locator("#tolerance svg[tabindex]");
  await picture.focus();
  let sum = 0,
    beyond = 0,
    width = 0;
  for (let k = 0, last = NaN; k < 40; k++) {
    await tab.keyboard.press("ArrowRight");
    const said = await tab.locator("#tolerance .tip").innerText(),
      at = number(said.match(/of about (\S+)/)[1]),
      part = number(said.match(/samples\s+(\S+)/)[1]);
    sum += part;
    if (at < least.at_least) beyond += part;
    if (k) width = at - last;
    last = at;
  }
  assert.ok(Math.abs(sum - 100) < 1e-3, `bars of ${sum} % in all`);
  const samples = samplesOf(made, `/tolerance/load_case/cold/tension_min_${least.set}`),
    below = (v) => (100 * samples.filter((sample) => sample < v).length) / samples.length;
  assert.ok(beyond >= below(least.at_least - width) - 1 && beyond <= below(least.at_least + width) + 1, `${beyond} %`);
  await tab.keyboard.press("Escape");
  const tension_N = samplesOf(made, `/tolerance/load_case/cold/tension_min_${least.set}`, false),
    cable = samplesOf(made, `/tolerance/load_case/cold/tension_min_${least.set}_cable`, false),
    counts = new Map(),
    failing = cable.filter((_, i) => tension_N[i] < least.at_least);
  for (const e of failing) counts.set(made.cables[e].id, (counts.get(made.cables[e].id) || 0) + 1);
  const [top, ...more] = await tab
    .locator("#tolerance tbody tr")
    .evaluateAll((all) => all.map((row) => [row.children[0].textContent, row.children[2].textContent]));
  assert.equal(counts.get(top[0]), Math.max(...counts.values()), "not the cable that fails most");
  for (const [id, share] of [top, ...more]) same(number(share), (100 * counts.get(id)) / failing.length, 3);
  assert.equal(least.worst_load_case, "cold");
  assert.equal(made.cables[cable[least.worst_sample]].id, least.worst_item);
}

// Returns the values of a data set, sorted or in the order of the samples, or null if the file has none.
function samplesOf(made, name, isSorted = true) {
  const read =
    "import h5py,json,sys;f=h5py.File(sys.argv[1]);n=sys.argv[2]\n" +
    "print(json.dumps(f[n][:].tolist() if n in f else None))";
  const values = JSON.parse(
    execFileSync("/usr/bin/python3", ["-c", read, join(made.folder, "result.h5"), name], { encoding: "utf8" }),
  );
  return values && isSorted ? values.sort((a, b) => a - b) : values;
}

// Bars as high as the samples are many, a line for each figure at its place, and the cables of the file.
export async function checkTolerance(tab, made) {
  const t = made.summary.tolerance,
    legend = await tab.locator("#tolerance .legend > span").allTextContents(),
    named = legend.filter((text) => text.endsWith(" mm")).map((text) => number(text.match(/([^ ]+) mm$/)[1]));
  assert.equal(await tab.locator("#tolerance line.curve").count(), 2);
  [t.nominal_psi_m, t.psi_95_m].forEach((at, k) => same(named[k], 1e3 * at, 5));
  const most = t.histogram.indexOf(Math.max(...t.histogram)),
    [low, high] = t.histogram_range_m;
  await tab.locator("#tolerance svg[tabindex]").focus();
  for (let k = 0; k <= most; k++) await tab.keyboard.press("ArrowRight");
  const said = await tab.locator("#tolerance .tip").innerText();
  same(number(said.match(/samples\s+([\d.]+)/)[1]), 100 * t.histogram[most], 6);
  same(number(said.match(/of ([\d.]+) to/)[1]), 1e3 * (low + (most * (high - low)) / t.histogram.length), 5);
  const rows = await tab.locator("#tolerance tbody th").allTextContents();
  assert.deepEqual(
    rows,
    t.cable_share.map(({ cable }) => cable),
  );
}

// The points come first, in a table of their values, slopes and verdicts. Objectives are in units that people read.
// Each point has a mark, and is named by its values. A design before the optimisation that is far off does not flatten
// the front but is told. The shape below is said to be no point.
export async function checkFront(browser, tab, made, folder) {
  const { initial, points, knee, minimised } = made.summary.front,
    [psi, ratio] = Object.keys(initial),
    picture = tab.locator("#front svg[tabindex]");
  assert.equal(await tab.locator("main > :not(noscript)").first().getAttribute("id"), "front");
  const cells = await tab
    .locator("#front tbody tr")
    .evaluateAll((all) => all.map((row) => [...row.children].map((c) => c.textContent)));
  assert.equal(cells.length, points.length);
  points.forEach(({ objective, multiplier, id }, k) => {
    const [u, v, slope, position, number_] = cells[k];
    same(number(u), 1e3 * objective[psi], 5);
    same(number(v), objective[ratio], 5);
    assert.equal(minimised, psi);
    if (multiplier[ratio] === null) assert.equal(slope, "–");
    else same(number(slope), -1e3 * multiplier[ratio], 3);
    assert.deepEqual([position, number_], [k === knee ? "knee" : "on the front", String(id)]);
  });
  const dots = await picture.locator("path.dots").evaluateAll((all) => all.map((p) => p.getAttribute("d")));
  assert.ok(
    dots.some((d) => d.match(/h0/g).length === points.length),
    `no mark for each point: ${dots}`,
  );
  assert.deepEqual(await picture.locator(".label").allTextContents(), ["ψ (mm)", "ratio boundary"]);
  const highest = number(await picture.locator("text[text-anchor=end]").last().textContent());
  assert.ok(highest < Math.max(...points.map(({ objective }) => objective[ratio])) && initial[ratio] > 1.01);
  const caption = await tab.locator("#front figcaption").textContent();
  same(number(caption.match(/ratio boundary of the initial design \(([\d.]+)\)/)[1]), initial[ratio], 6);
  await picture.focus();
  await tab.keyboard.press("End");
  const [, x, y] = (await tab.locator("#front .tip strong").textContent()).match(
    /^ψ ([\d.]+) mm, ratio boundary (.*)$/,
  );
  same(number(x), 1e3 * points.at(-1).objective[psi], 6);
  same(number(y), points.at(-1).objective[ratio], 6);
  await tab.keyboard.press("Escape");
  assert.match(await tab.locator("#front code").textContent(), /^hifdm run .* --point .*\.h5:\d -o point\d\.h5$/);
  assert.equal(await tab.locator("#net h2").textContent(), "The net after form-finding");
  assert.match(await tab.locator("#net h2 + #whose").textContent(), / after form-finding\. .* is not a point /);
  assert.equal(await tab.locator("main > .figures").count(), 0, "figures of a shape that is no point");
  const row = tab.locator("#summary tr", { hasText: psi });
  same(number(await row.locator(".number").first().textContent()), 1e3 * initial[psi], 5);
  await checkJudgedFront(browser, made, folder);
}

// The verdicts in the table are those of the file.
export async function checkVerdictsOfFront(tab, made) {
  const cells = await tab.locator('#front td[data-label="Verdict"]').allTextContents(),
    expected = made.summary.front.points.map(({ verdict, requirements_failed: n }) => verdict + (n ? ` (${n})` : ""));
  assert.deepEqual(cells, expected);
  assert.ok(new Set(expected).size > 1, "all points have the same verdict");
}

// Many points, with verdicts: each has its mark, of the colour of its verdict. In a copy of the page with such points.
async function checkJudgedFront(browser, made, folder) {
  const page = readFileSync(made.html, "utf8"),
    data = JSON.parse(page.match(DATA)[2]),
    { front } = data.summary,
    [first] = front.points;
  front.points = Array.from({ length: 40 }, (_, k) => ({
    ...first,
    id: k + 1,
    objective: Object.fromEntries(Object.keys(first.objective).map((key, j) => [key, j ? 3 - k / 40 : 0.01 + k / 1e4])),
    verdict: k < 10 ? "undecided" : k < 30 ? "pass" : "fail",
    requirements_failed: k < 30 ? 0 : 2,
    requirements_undecided: k < 10 ? 1 : 0,
  }));
  const copy = page.replace(DATA, (_, head, old, tail) => head + JSON.stringify(data) + tail);
  await openCopy(browser, folder, "judged", copy, async (tab) => {
    const dots = await tab
      .locator("#front svg[tabindex] path.dots")
      .evaluateAll((all) => all.map((p) => p.getAttribute("d").match(/h0/g).length));
    for (const n of [40, 20, 10]) assert.ok(dots.includes(n), `${n} points of a kind, but marks of ${dots}`);
    const legend = await tab.locator("#front .legend").innerText();
    for (const word of ["passes", "fails", "undecided"]) assert.ok(legend.includes(word), legend);
    assert.deepEqual(
      await tab
        .locator('#front td[data-label="Verdict"]')
        .evaluateAll((all) => [...new Set(all.map((c) => c.innerText))]),
      ["undecided (1)", "pass"],
    );
  });
}
