// What the checks share: tables that the program writes, numbers as a page shows them, pictures and tooltips of a tab.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

export const DATA = /(<script type="application\/json" id="data">)([^]*?)(<\/script>)/; // of a page

export function csv(path) {
  const lines = readFileSync(path, "utf8").trimEnd().split("\n");
  const cells = (line) =>
    [...line.matchAll(/("((?:[^"]|"")*)"|[^,]*)(,|$)/g)].map((m) => (m[2] ?? m[1]).replace(/""/g, '"'));
  const names = cells(lines[0]);
  return lines.slice(1).map((line) => Object.fromEntries(cells(line).map((cell, k) => [names[k], cell])));
}

export const same = (shown, value, digits) => {
  assert.ok(Number.isFinite(value), `${shown} is shown, and there is no value`);
  const near = Math.abs(shown - value) <= 0.51 * 10 ** (Math.floor(Math.log10(Math.abs(value) || 1)) - digits + 1);
  assert.ok(near || Math.abs(shown - value) < 1e-9, `${shown} is shown for ${value}`);
};
// "−1.2×10⁻⁷ N" -> -1.2e-7
export const number = (text) =>
  parseFloat(
    text
      .replace("−", "-")
      .replace(
        /×10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/,
        (_, e) => "e" + [...e].map((c) => (c === "⁻" ? "-" : "⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c))).join(""),
      ),
  );

export const settle = (tab) =>
  tab.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
// Colours of a canvas: how many there are, and a sum that tells two pictures apart.
export const picture = async (tab, canvas) => {
  await settle(tab);
  return tab.evaluate((id) => {
    const node = document.getElementById(id),
      copy = document.createElement("canvas");
    const c = Object.assign(copy, { width: node.width, height: node.height }).getContext("2d", {
      willReadFrequently: true,
    });
    c.drawImage(node, 0, 0);
    const pixel = c.getImageData(0, 0, node.width, node.height).data;
    const colours = new Set();
    let sum = 0;
    for (let k = 0; k < pixel.length; k += 4) {
      const colour = (pixel[k] << 16) | (pixel[k + 1] << 8) | pixel[k + 2];
      if (pixel[k + 3]) colours.add(colour);
      sum = (Math.imul(sum, 31) + colour + pixel[k + 3]) | 0;
    }
    return { colours: colours.size, sum };
  }, canvas);
};
export const tip = async (tab, stage) => {
  await settle(tab);
  return tab.evaluate((name) => {
    const node = document.querySelector(`.stage.${name} .tip`);
    if (node.hidden) return null;
    const rows = [...node.querySelectorAll("tr")].map((r) => [...r.children].map((c) => c.textContent));
    return { heading: node.querySelector("strong").textContent, ...Object.fromEntries(rows) };
  }, stage);
};

export async function changes(tab, what, act) {
  const before = await picture(tab, "net-canvas");
  await act();
  assert.notEqual((await picture(tab, "net-canvas")).sum, before.sum, `${what} leaves the picture as it was`);
}

// Opens a copy of a page; what it did to the tripwire window.hit.
export async function openCopy(browser, folder, name, text, look = () => {}) {
  const copy = join(folder, `${name}.html`),
    tab = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  writeFileSync(copy, text);
  await tab.goto(pathToFileURL(copy).href);
  await settle(tab);
  await look(tab);
  const hit = await tab.evaluate("window.hit");
  await tab.close();
  return hit;
}
