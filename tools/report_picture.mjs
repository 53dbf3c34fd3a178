// The net of a report as an SVG, as the page draws it: its canvas is given a pen that writes down what it is told.
//     tests/browser/run.sh --node tools/report_picture.mjs configs/paraboloid-6m.yaml results/report.svg
import { execFileSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { HIFDM, CHROMIUM, WORK } = process.env;
const { chromium } = createRequire(join(WORK, "package.json"))("playwright-core");
const [source, target] = process.argv.slice(2),
  width = 900,
  folder = join(WORK, "picture");
mkdirSync(folder, { recursive: true });
const hifdm = (...words) => execFileSync(HIFDM, words, { cwd: folder, encoding: "utf8" });
hifdm("run", resolve(source), "-o", "picture.h5", "--restart", "--quiet");
const answer = hifdm("show", "picture.h5").split("\n")[0];
hifdm("report", "picture.h5", "-o", "picture.html", "--force");

// Lines of one colour and width become one path; each drawing of the page begins the list anew.
function record() {
  const drawn = (window.drawn = new Map()); // by canvas
  const digits = (v) => String(Math.round(v * 10) / 10);
  let at = "",
    paths;
  const get = HTMLCanvasElement.prototype.getContext;
  const pen = {
    setTransform: () => paths.clear(),
    beginPath: () => (at = ""),
    moveTo: (x, y) => (at += `M${digits(x)} ${digits(y)}`),
    lineTo: (x, y) => (at += `L${digits(x)} ${digits(y)}`),
    arc: (x, y, r) => {
      const d = digits(r);
      at += `M${digits(x - r)} ${digits(y)}a${d} ${d} 0 1 0 ${digits(2 * r)} 0a${d} ${d} 0 1 0 ${digits(-2 * r)} 0`;
    },
    rect: (x, y, w, h) => (at += `M${digits(x)} ${digits(y)}h${digits(w)}v${digits(h)}h${digits(-w)}z`),
    closePath: () => (at += "z"),
    stroke: (c) => add(`fill="none" stroke="${c.strokeStyle}" stroke-width="${digits(c.lineWidth)}"`, c),
    fill: (c) => add(`fill="${c.fillStyle}"`, c),
  };
  const add = (look, c) => {
    const key = c.globalAlpha < 1 ? `${look} opacity="${c.globalAlpha}"` : look;
    paths.set(key, (paths.get(key) || "") + at);
  };
  HTMLCanvasElement.prototype.getContext = function (kind) {
    const c = get.call(this, kind);
    if (kind !== "2d" || c.isRecorded) return c;
    c.isRecorded = true;
    for (const [name, note] of Object.entries(pen)) {
      const draw = c[name].bind(c);
      c[name] = (...numbers) => {
        if (!drawn.has(this)) drawn.set(this, new Map());
        paths = drawn.get(this);
        if (name === "stroke" || name === "fill") note(c);
        else note(...numbers);
        return draw(...numbers);
      };
    }
    return c;
  };
}

const browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1000, height: 900 } });
await page.addInitScript(record);
await page.goto(pathToFileURL(join(folder, "picture.html")).href);
await page.waitForSelector("canvas");
await page.evaluate(() => {
  Object.assign(report.net.state, { colour: "tension", theory: false, scale: 1 });
  report.net.look(-38, 30);
  report.net.zoom(1.2);
});
await page.waitForTimeout(500);
const seen = await page.evaluate(() => {
  const canvas = document.querySelector("#net canvas");
  return {
    paths: [...window.drawn.get(canvas)],
    width: canvas.clientWidth,
    height: canvas.clientHeight,
    title: document.querySelector("h1").textContent,
    colours: Array.from({ length: 32 }, (_, k) => rgb(sequential(k / 31))),
    ends: [...document.querySelectorAll("#net .bar .ticks > *")].map((tick) => tick.textContent),
  };
});
await browser.close();
const escape = (text) => text.replace(/[&<>]/g, (c) => `&#${c.charCodeAt(0)};`);
const bar = seen.colours
  .map((c, k) => `<rect x="${24 + 6 * k}" y="${seen.height + 4}" width="6.5" height="9" fill="${c}"/>`)
  .join("");
const ticks = seen.ends.map((v, k) => `<text x="${24 + (192 * k) / (seen.ends.length - 1)}">${escape(v)}</text>`);
const body = seen.paths.map(([look, d]) => `<path ${look} d="${d}"/>`).join("\n");
writeFileSync(
  target,
  `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 -50 ${seen.width} ${seen.height + 80}" width="${width}">
<title>${escape(seen.title)}</title>
<rect y="-50" width="100%" height="100%" fill="#ffffff"/>
<g font-family="system-ui, sans-serif" fill="#1b1f24">
<text x="24" y="-22" font-size="17" font-weight="600">${escape(seen.title)}</text>
<text x="24" y="-2" font-size="13">${escape(answer)}</text>
${bar}
<text x="24" y="${seen.height - 2}" font-size="12">tension (N)</text>
<g font-size="11" text-anchor="middle" transform="translate(0 ${seen.height + 25})">${ticks.join("")}</g>
</g>
<g stroke-linecap="round">
${body}
</g>
</svg>
`,
);
