// Pictures of pages of `hifdm report` for the manual: pictures.mjs LIST.json, rows {page, part, file[, press][, only]}:
// the part of the page, by its selector, as a PNG of 900 points width, two pixels to a point; after a button was
// pressed, or only the first element of a kind in it.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { CHROMIUM, WORK } = process.env;
const { chromium } = createRequire(join(WORK, "package.json"))("playwright-core");
const browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
const viewport = { width: 900, height: 700 };
const tab = await browser.newPage({ viewport, deviceScaleFactor: 2, colorScheme: "light" });
for (const { page, part, file, press, only } of JSON.parse(readFileSync(process.argv[2], "utf8"))) {
  await tab.goto(pathToFileURL(resolve(page)).href);
  if (press) await tab.locator(part).getByLabel(press, { exact: true }).first().click();
  const node = only ? tab.locator(`${part} ${only}`).first() : tab.locator(part);
  await node.scrollIntoViewIfNeeded({ timeout: 10000 });
  await tab.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const box = await node.boundingBox();
  if (!box || box.height < 50) throw new Error(`${page}: nothing to see of ${part}`);
  await node.screenshot({ path: file });
}
await browser.close();
