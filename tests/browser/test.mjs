// Opens every page of pages.mjs in headless Chromium and looks at it as its readers would: is everything drawn, is what
// is under the pointer the value in the file, do mouse and keyboard work, in the light, in the dark and on paper?
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { checkOther, checkUnlike } from "./compare.mjs";
import { checkHostile } from "./hostile.mjs";
import { checkFluid } from "./large.mjs";
import { checkLook, inspect } from "./look.mjs";
import { pages } from "./pages.mjs";
import {
  checkAdjust,
  checkFront,
  checkVerdictsOfFront,
  checkPattern,
  checkRequirements,
  checkRounding,
  checkTolerance,
  checkWords,
} from "./parts.mjs";
import { checkFacets, checkHover, checkMap, checkNet, checkOverlay } from "./pictures.mjs";
import { changes, csv, DATA, picture, settle } from "./see.mjs";
import { checkPoints, checkSurfaceOfStudy, checkVerdicts } from "./study.mjs";
import { checkCables, checkChange, checkCharts, checkSummary, checkUnknownFigure } from "./tables.mjs";

const { HIFDM, CHROMIUM, WORK } = process.env;
const { chromium } = createRequire(join(WORK, "package.json"))("playwright-core");
const SIZE_MAX = 1e6; // bytes: the promise of the README

// ---- making a page and the numbers to hold it against ----

function build(page, folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const hifdm = (...words) =>
      execFileSync(HIFDM, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }),
    result = page.study ? "study.h5" : "result.h5",
    html = join(folder, "report.html");
  for (const [name, text] of Object.entries(page.files || {})) writeFileSync(join(folder, name), text);
  const source = page.source ? resolve(page.source) : page.study ? "study.yaml" : "case.yaml";
  if (page.text) writeFileSync(join(folder, source), page.text);
  const run = (file, more = []) => {
    try {
      hifdm("run", source, ...more, "-o", file, "--quiet");
    } catch (error) {
      if (!page.fails || error.status !== 3) throw error;
    }
  };
  if (page.study) {
    hifdm("sweep", source);
    hifdm("merge", source);
  } else {
    run(result);
  }
  const beside = page.other ? ["other.h5"] : [];
  if (page.other) run("other.h5", page.other);
  if (page.measured) {
    hifdm("export", result, "--csv", ".");
    writeFileSync(join(folder, "measured.csv"), page.measured(csv(join(folder, "nodes.csv"))));
  }
  const start = performance.now();
  if (page.measured)
    hifdm(
      ...["adjust", source, "--measured", "measured.csv", "--result", result],
      ...["-o", "adjustments.csv", "--report", html],
    );
  else hifdm("report", result, ...beside, "-o", html);
  const made = { html, hifdm, folder, made_ms: performance.now() - start };
  if (page.study) return { ...made, study: JSON.parse(readFileSync(html, "utf8").match(DATA)[2]).study };
  hifdm("export", result, "--csv", ".", "--force");
  return {
    ...made,
    nodes: csv(join(folder, "nodes.csv")),
    cables: csv(join(folder, "cables.csv")),
    summary: JSON.parse(hifdm("show", result, "--json")),
  };
}

// ---- the checks, one after the other on an open page ----

async function checkText(tab, page) {
  if (page.title) {
    assert.equal(await tab.locator("h1").textContent(), page.title);
    assert.equal(await tab.title(), page.title);
  }
  const sections = await tab.locator("main section").evaluateAll((all) => all.map((s) => s.id));
  assert.deepEqual(
    sections.filter((id) => !(page.maybe || []).includes(id)),
    page.sections,
  );
  assert.equal(await tab.evaluate("window.hit"), undefined, "a text of the case became markup");
  assert.equal(await tab.locator("main img, main i, main b, main script").count(), 0);
  const text = await tab.locator("body").innerText();
  for (const word of ["NaN", "undefined", "null", "Infinity", "[object"])
    assert.ok(!text.includes(word), `the page says ${word}`);
  if (page.warnings !== undefined) assert.equal(await tab.locator("#warnings li").count(), page.warnings);
}

async function checkRules(tab) {
  assert.equal(await tab.locator("th:not([scope])").count(), 0, "a heading of a table without scope");
  assert.equal(await tab.locator("button:not([type])").count(), 0);
  assert.equal(await tab.locator("canvas:not([aria-label]), svg[role=img]:not([aria-label])").count(), 0);
  assert.equal(
    await tab
      .locator("input")
      .evaluateAll((all) => all.filter((i) => !i.labels.length && !i.getAttribute("aria-label")).length),
    0,
    "an input without a label",
  );
}

const background = (tab) =>
  tab.evaluate(
    () =>
      getComputedStyle(document.body)
        .backgroundColor.match(/\d+/g)
        .slice(0, 3)
        .reduce((a, b) => a + Number(b), 0) / 3,
  );

// The pictures follow the scheme of colours, and paper is light.
async function checkMedia(tab, pictures) {
  const seen = {};
  for (const [name, media] of [
    ["light", { colorScheme: "light", media: "screen" }],
    ["dark", { colorScheme: "dark", media: "screen" }],
    ["print", { colorScheme: "dark", media: "print" }],
  ]) {
    await tab.emulateMedia(media);
    seen[name] = {
      paper: await background(tab),
      sums: await Promise.all(pictures.map(async (name) => (await picture(tab, name)).sum)),
      tools: await tab.locator(".tools").first().isVisible(),
      chosen: await tab.locator(".paper:visible").allInnerTexts(),
    };
  }
  assert.ok(seen.light.paper > 230 && seen.dark.paper < 50 && seen.print.paper > 250, "wrong colour of the paper");
  pictures.forEach((name, k) => {
    assert.notEqual(seen.light.sums[k], seen.dark.sums[k], `${name} does not follow the dark scheme`);
    assert.notEqual(seen.print.sums[k], seen.dark.sums[k], `${name} is printed in the dark`);
  });
  assert.ok(seen.light.tools && !seen.print.tools, "controls on paper");
  const tools = tab.locator(".tools:has([type=radio])").first(),
    labels = await tools.locator("label:has([type=radio]:checked)").allTextContents(),
    told = seen.print.chosen,
    has = (text) => labels.every((label) => text.includes(`: ${label}`)); // a study of one axis has nothing to choose
  assert.ok(labels.length ? told.some(has) : !pictures.length, told.join("; "));
  await tab.emulateMedia({ colorScheme: "light", media: "screen" });
  assert.equal(await tab.locator(".paper:visible").count(), 0, "on a screen the controls say it");
  await tab.setViewportSize({ width: 360, height: 700 });
  await settle(tab);
  assert.deepEqual((await tab.evaluate(inspect)).faults, [], "on a telephone");
}

// ---- all pages ----

async function test(browser, page) {
  const folder = join(WORK, page.name),
    made = build(page, folder),
    bytes = statSync(made.html).size;
  assert.ok(bytes < (page.bytes_max || SIZE_MAX), `${bytes} bytes`);
  const url = pathToFileURL(made.html).href,
    trouble = [];
  const tab = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  tab.on("console", (message) => trouble.push(`console: ${message.text()}`));
  tab.on("pageerror", (error) => trouble.push(`error: ${error.message}`));
  tab.on("request", (request) => request.url() === url || trouble.push(`request: ${request.url()}`));
  await tab.goto(url);
  await checkText(tab, page);
  let said = "";
  if (page.overlay) await checkOverlay(tab);
  if (page.says) {
    for (const [place, text] of Object.entries(page.says)) {
      const said = await tab.locator(place).textContent();
      if (text instanceof RegExp) assert.match(said, text);
      else assert.equal(said.trim(), text);
    }
  } else if (page.fluid) {
    said = `; ${await checkFluid(tab, url)}`;
  } else if (page.judged) {
    await checkVerdicts(tab, page, made);
  } else if (page.study && !page.leads) {
    await checkSurfaceOfStudy(tab, made.study);
  } else if (page.study) {
    const chosen = tab.locator("#sweep input[name=axis]:checked");
    assert.equal(await chosen.getAttribute("value"), page.leads, "the axis at first is not the one that matters most");
    await tab.locator(`#sweep input[name=axis]:not([value="${page.leads}"])`).check();
    const flat = await tab.locator("#sweep > p.flat").innerText();
    assert.match(flat, /^The following quantities do not depend on pretension: .*error ψ/);
    assert.equal(await tab.locator("#sweep .chart").count(), 0);
    await checkPoints(tab, page, made);
  } else {
    await checkSummary(tab, made, page);
    const isOptimised = ["search", "refine", "front"].some((key) => key in made.summary);
    const subtitle = await tab.locator("#subtitle").textContent();
    assert.equal(/ variables,/.test(subtitle), isOptimised);
    assert.equal(/before optimisation; the result scales variables by /.test(subtitle), made.summary.scale_min > 0);
    if (page.name === "chen2022") await checkWords(tab, made);
    if (page.name === "chen2022") await checkChange(browser, made, folder);
    const endless = await checkCharts(tab, 4, "#form-finding", /iteration \d+\s+ψ\s+[\d.]+.* mm/);
    await checkNet(tab, page, made);
    if (page.unlike) await checkUnlike(browser, tab, made, folder);
    else if (page.other) await checkOther(tab, page, made);
    else await checkCables(tab, made);
    await checkHover(tab, page, made);
    if (page.slack) assert.ok(endless.includes("Tension ratio, boundary cables"), "an infinite ratio is not shown");
    if (page.rounding) await checkRounding(tab, made);
    else await checkMap(tab, made);
    if (page.facets) await checkFacets(tab, page, made);
    if (page.name === "front") await checkFront(browser, tab, made, folder);
    if (page.name === "front-judged") await checkVerdictsOfFront(tab, made);
    if (page.measured) await checkAdjust(tab, made, changes);
    if (page.pattern) await checkPattern(tab, page, made);
    if (made.summary.requirements && !made.summary.front) await checkRequirements(tab, made);
    else if (made.summary.tolerance && !page.measured) await checkTolerance(tab, made);
    await checkUnknownFigure(browser, made, folder);
  }
  if (page.study || page.other || page.slack !== undefined) await checkHostile(browser, made, folder);
  await checkRules(tab);
  if (!page.fluid) await checkMedia(tab, page.study ? [] : ["net-canvas", "map-canvas"]);
  if (page.look) await checkLook(tab, page, folder);
  assert.deepEqual(trouble, []);
  await tab.close();
  return `${(bytes / 1e3).toFixed(0)} kB, written in ${made.made_ms.toFixed(0)} ms${said}`;
}

const wanted = process.argv.slice(2),
  browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
let failed = 0;
for (const page of pages.filter((p) => !wanted.length || wanted.includes(p.name))) {
  try {
    console.log(`${page.name}: ${await test(browser, page)}`);
  } catch (error) {
    failed++;
    console.log(`${page.name}: FAILED: ${error.stack}`);
  }
}
await browser.close();
console.log(failed ? `${failed} pages failed` : "all pages are as they should be");
process.exitCode = failed ? 1 : 0;
