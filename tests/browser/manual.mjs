// Every page of the manual (`make docs`) on a phone of 400 pixels, some on a desk, light and dark: nothing wider than
// the page, nothing that a browser complains about, and the search finds a word.
import assert from "node:assert/strict";
import { readdirSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { CHROMIUM, WORK, DOCS } = process.env;
const { chromium } = createRequire(join(WORK, "package.json"))("playwright-core");
const folder = resolve(DOCS);
const pages = readdirSync(folder, { recursive: true })
  .filter((name) => name.endsWith(".html") && !name.startsWith("_static"))
  .sort();
assert.ok(pages.length > 20 && statSync(join(folder, "index.html")).size > 0, `${pages.length} pages in ${folder}`);

const browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
const faults = [];
for (const colorScheme of ["light", "dark"]) {
  const tab = await browser.newPage({ viewport: { width: 400, height: 800 }, colorScheme });
  tab.on("console", (message) => message.type() === "error" && faults.push(`${tab.url()}: ${message.text()}`));
  tab.on("pageerror", (error) => faults.push(`${tab.url()}: ${error}`));
  tab.on("request", (asked) => asked.url().startsWith("http") && faults.push(`${tab.url()}: asks ${asked.url()}`));
  for (const name of pages) {
    await tab.goto(pathToFileURL(join(folder, name)).href);
    const seen = await tab.evaluate(() => ({
      width: document.documentElement.scrollWidth,
      wide: [...document.querySelectorAll("article *")].find((node) => node.getBoundingClientRect().right > 401)
        ?.outerHTML.slice(0, 90),
      back: getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).map(Number),
    }));
    if (seen.width > 400) faults.push(`${name}: ${seen.width} pixels wide on a phone of 400; ${seen.wide}`);
    const bright = seen.back.every((part) => part > 128);
    if (bright !== (colorScheme === "light")) faults.push(`${name}: background ${seen.back} in the ${colorScheme}`);
  }
  // A desk: its column is not cut, the first page is seen at once, and code that goes on has a shadow at its edge.
  await tab.setViewportSize({ width: 1400, height: 900 });
  for (const name of ["index.html", "tutorial.html"]) {
    await tab.goto(pathToFileURL(join(folder, name)).href);
    const seen = await tab.evaluate(() => ({
      width: document.documentElement.scrollWidth,
      lists: Math.max(0, ...[...document.querySelectorAll("article .toctree-wrapper")].map((l) => l.offsetTop)),
      bare: [...document.querySelectorAll("article pre")].filter(
        (code) => code.scrollWidth > code.clientWidth && !getComputedStyle(code).backgroundImage.includes("gradient"),
      ).length,
    }));
    if (seen.width > 1400) faults.push(`${name}: ${seen.width} pixels wide on a desk of 1400`);
    if (seen.lists > 900) faults.push(`${name}: its last list begins at ${seen.lists} pixels`);
    if (seen.bare) faults.push(`${name}: ${seen.bare} blocks of code are cut without a sign`);
  }
  await tab.goto(pathToFileURL(join(folder, "search.html")).href + "?q=scallop");
  await tab.waitForSelector("ul.search li a", { timeout: 10000 }).catch(() => faults.push("search: nothing"));
  await tab.close();
}
await browser.close();
console.log(faults.length ? faults.join("\n") : `manual: ${pages.length} pages at 400 pixels, light and dark`);
process.exit(faults.length ? 1 : 0);
