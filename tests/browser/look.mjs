// How a page looks: nothing hidden, cut or too faint, in light and dark, on desk, phone and paper; every control within
// reach of the keyboard and with a name; colours that people with any colour vision tell apart.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { settle } from "./see.mjs";

const WIDTHS = [1400, 400], // pixels: a desk, a phone
  A4_WIDTH = 718, // pixels between margins of 1 cm
  HEIGHT_WITHIN = 0.1; // of that in sizes.json, or one sheet: fonts differ
const sizes = JSON.parse(readFileSync(new URL("sizes.json", import.meta.url), "utf8"));

// ---- in the page ----

// How high the page is, and what of it is too wide, cut off, or too faint.
export function inspect() {
  const faults = new Set(),
    wide = document.documentElement.clientWidth;
  const bytes = (colour) => {
    const [r, g, b, a = 1] = colour.match(/[\d.]+/g).map(Number);
    return { rgb: [r, g, b], a };
  };
  const luminance = (rgb) =>
    rgb
      .map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4))
      .reduce((sum, v, k) => sum + [0.2126, 0.7152, 0.0722][k] * v, 0);
  const over = (front, back) => front.rgb.map((v, k) => front.a * v + (1 - front.a) * back[k]);
  const contrast = (front, back) => {
    const [low, high] = [luminance(over(front, back)), luminance(back)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  };
  const behind = (node) => {
    for (let at = node; at; at = at.parentElement) {
      const paint = bytes(getComputedStyle(at).backgroundColor);
      if (paint.a) return over(paint, at.parentElement ? behind(at.parentElement) : [255, 255, 255]);
    }
    return [255, 255, 255];
  };
  const named = (node) =>
    `${node.tagName.toLowerCase()}${node.getAttribute("class") ? "." + node.getAttribute("class") : ""} in ` +
    `${node.closest("section, header, footer")?.id || "the head"}: ${node.textContent.slice(0, 50)}`;
  const isSeen = (node) => node.checkVisibility({ visibilityProperty: true }) && node.getClientRects().length > 0;
  const isAside = (node) => {
    const scroller = node.closest(".scroll");
    return (scroller && getComputedStyle(scroller).overflowX !== "visible") || node.closest(".skip, .hidden");
  };

  const isOutside = (box) => box.right > wide + 1 || box.left < -1;

  for (const node of document.querySelectorAll("body *")) {
    if (!isSeen(node) || node.closest("script, clipPath, .at")) continue;
    const style = getComputedStyle(node),
      box = node.getBoundingClientRect(),
      isInSvg = node.ownerSVGElement;
    if (isOutside(box) && !isAside(node) && !isOutside(node.parentElement.getBoundingClientRect()))
      faults.add(`outside: ${named(node)}`);
    if (/hidden|clip/.test(style.overflowX) && node.scrollWidth > node.clientWidth + 1 && !isInSvg)
      faults.add(`cut off: ${named(node)}`);
    const isClamped = isInSvg || style.webkitLineClamp !== "none"; // some lines and an ellipsis
    if (!isClamped && /hidden|clip/.test(style.overflowY) && node.scrollHeight > node.clientHeight + 1)
      faults.add(`cut off below: ${named(node)}`);
    const hasText = [...node.childNodes].some((child) => child.nodeType === 3 && child.data.trim());
    if (hasText && !node.closest(".skip, .hidden")) {
      const size = parseFloat(style.fontSize),
        isLarge = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 600);
      const ratio = contrast(bytes(isInSvg ? style.fill : style.color), behind(node));
      if (ratio < (isLarge ? 3 : 4.5)) faults.add(`contrast ${ratio.toFixed(2)}: ${named(node)}`);
    }
    if (isInSvg && node.matches("path.curve, path.dots, line.curve")) {
      const ratio = contrast(bytes(style.stroke), behind(node));
      if (ratio < 3) faults.add(`contrast ${ratio.toFixed(2)} of a line: ${named(isInSvg.closest("figure") || node)}`);
    }
  }
  for (const picture of document.querySelectorAll("svg[tabindex]")) {
    const frame = picture.getBoundingClientRect(),
      texts = [...picture.querySelectorAll("text")].map((t) => [t, t.getBoundingClientRect()]);
    texts.forEach(([text, a], k) => {
      const where = `${text.textContent} in ${picture.getAttribute("aria-label").split(":")[0]}`;
      if (a.left < frame.left - 1 || a.right > frame.right + 1) faults.add(`label cut off: ${where}`);
      for (const [, b] of texts.slice(k + 1))
        if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 3 && b.top < a.bottom - 3)
          faults.add(`labels on each other: ${where}`);
    });
  }
  for (const scroller of document.querySelectorAll(".scroll"))
    if (scroller.scrollWidth > scroller.clientWidth + 1) faults.add(`columns out of sight: ${named(scroller)}`);
  const root = document.documentElement;
  if (root.scrollWidth > wide) faults.add(`scrolls sideways: ${root.scrollWidth} pixels`);
  return { height: root.scrollHeight, faults: [...faults] };
}

// Words and numbers of tables that are broken in two, but for names, which may have any length.
function brokenWords() {
  const broken = [],
    range = document.createRange();
  for (const cell of document.querySelectorAll("table :is(thead th, td.number, tbody th:not(:has(button)))")) {
    if (cell.closest(".tip") || !cell.checkVisibility()) continue;
    const walk = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    for (let node = walk.nextNode(); node; node = walk.nextNode())
      for (const { 0: word, index } of node.data.matchAll(/[^\s-]+/g)) {
        range.setStart(node, index);
        range.setEnd(node, index + word.length);
        if (range.getClientRects().length > 1) broken.push(`${word} of ${cell.textContent}`);
      }
  }
  return broken;
}

// The controls that are seen; of radio buttons with one name the one that is chosen stands for all.
function controls() {
  return [...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex='0']")].filter(
    (node) => node.checkVisibility({ visibilityProperty: true }) && !(node.type === "radio" && !node.checked),
  );
}

// ---- colours ----

// Simulated vision without one kind of cones: Machado, Oliveira & Fernandes 2009, severity 1, of linear RGB.
const VISION = {
  all: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
// sRGB bytes -> CIELAB of the white D65, as eyes of this kind see them.
function lab(rgb, vision) {
  const linear = rgb.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4)),
    times = (m, v) => [0, 1, 2].map((i) => m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2]);
  const seen = times(VISION[vision], linear).map((v) => Math.min(1, Math.max(0, v)));
  const [x, y, z] = times(
    [0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.072175, 0.0193339, 0.119192, 0.9503041],
    seen,
  ).map((v, k) => v / [0.95047, 1, 1.08883][k]);
  const f = (t) => (t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 / 116) * t + 16 / 116);
  return [116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))];
}
// The least distance in CIELAB between any two colours, and for whom.
export function leastDistance(colours) {
  let least = [Infinity];
  for (const vision of Object.keys(VISION))
    colours.forEach((a, i) =>
      colours.slice(0, i).forEach((b) => {
        const [p, q] = [lab(a, vision), lab(b, vision)],
          d = Math.hypot(...p.map((v, k) => v - q[k]));
        if (d < least[0]) least = [d, vision, a, b];
      }),
    );
  return least;
}

const SERIES_APART = 25; // in CIELAB, where 2 can just be told side by side

// The colours of series, as the page's style has them now.
async function checkPalette(tab, where) {
  const colours = await tab.evaluate(() => {
    const probe = document.body.appendChild(document.createElement("span"));
    const all = SERIES.map((name) => {
      probe.style.color = `var(${name})`;
      return getComputedStyle(probe).color.match(/\d+/g).map(Number);
    });
    probe.remove();
    return all;
  });
  const [least, vision, a, b] = leastDistance(colours);
  assert.ok(colours.length >= 4 && least >= SERIES_APART, `${where}: ${a} and ${b} are ${least} apart, ${vision}`);
}

// ---- keyboard and screen reader ----

// Every control is come to by the tab key alone, is then marked, and what can be pressed or read has a name.
async function checkKeyboard(tab) {
  const wanted = await tab.evaluateHandle(controls),
    count = await wanted.evaluate((all) => all.length);
  await tab.evaluate("document.activeElement.blur(), scrollTo(0, 0)");
  const missed = new Set(Array(count).keys()),
    unmarked = new Set();
  for (let k = 0; k < 2 * count + 10 && missed.size; k++) {
    await tab.keyboard.press("Tab");
    const [at, isMarked, name] = await wanted.evaluate((all) => {
      const node = document.activeElement,
        style = getComputedStyle(node);
      return [all.indexOf(node), style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1, node.outerHTML];
    });
    missed.delete(at);
    if (at >= 0 && !isMarked) unmarked.add(name.slice(0, 90));
  }
  const names = await wanted.evaluate((all, list) => list.map((k) => all[k].outerHTML.slice(0, 90)), [...missed]);
  assert.deepEqual(names, [], "the tab key does not come to these");
  assert.deepEqual([...unmarked], [], "not seen where the keyboard is");
  const reader = await tab.context().newCDPSession(tab),
    { nodes } = await reader.send("Accessibility.getFullAXTree");
  const nameless = nodes.filter(
    ({ ignored, role, name, properties = [] }) =>
      !ignored &&
      role.value !== "RootWebArea" &&
      (["img", "image", "table"].includes(role.value) ||
        properties.some((p) => p.name === "focusable" && p.value.value)) &&
      !(name && name.value.trim()),
  );
  const told = [];
  for (const { backendDOMNodeId } of nameless)
    told.push((await reader.send("DOM.getOuterHTML", { backendNodeId: backendDOMNodeId })).outerHTML.slice(0, 90));
  await reader.detach();
  assert.deepEqual(told, [], "without a name for screen readers");
}

// ---- a page ----

function checkSizes(page, found) {
  const wanted = sizes[page.name] || {},
    isNear = (what) => Math.abs(found[what] - wanted[what]) <= Math.max(1, HEIGHT_WITHIN * wanted[what]);
  assert.ok(
    Object.keys(found).every(isNear),
    `not the sizes of tests/browser/sizes.json; if it is as it should be: "${page.name}": ${JSON.stringify(found)}`,
  );
}

// On sheets: each has its number, none ends with a heading or with what is said above a table, none is lost, and a
// table that goes on has its heading again. Returns how many there are.
async function checkSheets(tab, folder) {
  for (const width of ["300px", ""]) {
    await tab.evaluate((room) => (document.body.style.width = room), width); // little, so that tables want more
    assert.deepEqual(await tab.evaluate(brokenWords), []);
  }
  const changes = await tab.locator(".chart svg[tabindex]").evaluateAll((all) =>
    all.filter((drawn) => {
      const before = drawn.clientHeight;
      drawn.setAttribute("viewBox", "0 0 900 290"); // drawn for another width, as when sheets are counted
      return drawn.clientHeight !== before;
    }),
  );
  assert.equal(changes.length, 0, "sheets are counted before charts are drawn for them");
  const heads = await tab.locator("h2, h3, .paper").evaluateAll((all) => all.map((h) => h.innerText.trim())),
    last = await tab.locator("footer").innerText(),
    path = join(folder, "report.pdf"),
    squeezed = (text) => text.replace(/\s+/g, " ").trim();
  writeFileSync(path, await tab.pdf({ format: "A4" }));
  const sheets = execFileSync("pdftotext", ["-layout", path, "-"], { encoding: "utf8" }).split("\f").slice(0, -1);
  sheets.forEach((sheet, k) => {
    const lines = sheet.split("\n").map(squeezed).filter((line) => line);
    assert.equal(lines.pop().replaceAll(" ", ""), `${k + 1}/${sheets.length}`);
    assert.ok(!heads.includes(lines.at(-1)), `sheet ${k + 1} ends with "${lines.at(-1)}"`);
    if (/^[a-z]+\d+_\d+-[a-z]+\d+_\d+ /.test(lines[0])) assert.fail(`sheet ${k + 1} begins with a row: ${lines[0]}`);
  });
  assert.ok(squeezed(sheets.join(" ")).includes(squeezed(last).slice(0, 60)), "the last sheet is lost");
  return sheets.length;
}

// Leaves pictures in the folder: on desk and phone, light and dark, and for paper.
export async function checkLook(tab, page, folder) {
  const faults = [],
    found = {};
  const look = async (name, width, media) => {
    await tab.emulateMedia(media);
    await tab.setViewportSize({ width, height: 900 });
    await tab.evaluate("document.activeElement.blur()");
    await settle(tab);
    const seen = await tab.evaluate(inspect);
    faults.push(...seen.faults.map((fault) => `${name}: ${fault}`));
    await checkPalette(tab, name);
    await tab.screenshot({ path: join(folder, `${name}.png`), fullPage: true });
    return seen.height;
  };
  for (const width of WIDTHS) {
    found[width] = await look(`${width} light`, width, { colorScheme: "light", media: "screen" });
    if (width === WIDTHS[0]) await checkKeyboard(tab);
    assert.equal(await look(`${width} dark`, width, { colorScheme: "dark", media: "screen" }), found[width]);
  }
  found.paper = await look("paper", A4_WIDTH, { colorScheme: "dark", media: "print" });
  const sheets = await checkSheets(tab, folder);
  await tab.emulateMedia({ colorScheme: "light", media: "screen" });
  assert.deepEqual(faults, []);
  checkSizes(page, { ...found, sheets });
}
