// ---- families: sets of cables ----

const familyName = (name) => name.replace(/_/g, " ");
// Returns the colour of a family: one of the series, or for many families one around the circle of hues with
// alternating lightness.
function familyColour(k) {
  if (net.sets.length <= SERIES.length) return css(SERIES[k]);
  const light = (isDark() ? 0.7 : 0.45) + 0.15 * (k % 2);
  return rgb(oklch(light, 0.14, 250 + (360 * k) / net.sets.length));
}

// Returns a line of a colour with its name.
function colourKey(colour, name) {
  const swatch = el("span", { class: "swatch" });
  swatch.style.background = colour; // set here, because the security policy of the page forbids style attributes
  return el("span", { class: "family" }, swatch, name);
}

// Draws the net in space. Lines of one colour are drawn in one call. Nothing is allocated while the net is turned.

const MANY_LINES = 4000; // a net with more lines loses details while it is turned
const REST_MS = 160; // time without a movement after which the details return

function netView({ canvas, tip, bar, scaleLabel, overlayLabel }) {
  // fitted: the zoom follows the size of the picture
  const view = { yaw: -35, pitch: 32, zoom: 1, panX: 0, panY: 0, fitted: true };
  const state = {
    shape: resultShape,
    colour: adjustmentOf.size ? "adjustments" : "deviation",
    scale: 1,
    target: true,
    truss: !!data.truss,
    picked: null,
    chosen: -1, // the cable selected by a click, here or in the table
    off: new Set(), // sets of cables that are hidden
    overlay: [], // shapes drawn over the shape, as lines of their colour
  };
  const target = data.net.position_m,
    n = net.n_node,
    m = net.n_cable,
    end = net.end,
    truss = data.truss;
  // Positions in space and on the screen: of the drawn net, of the target positions, of the truss.
  const drawn = { at: new Float64Array(3 * n), x: new Float32Array(n), y: new Float32Array(n) },
    ghost = { at: target, x: new Float32Array(n), y: new Float32Array(n) },
    beams = truss && {
      at: new Float64Array(3 * truss.n_node),
      x: new Float32Array(truss.n_node),
      y: new Float32Array(truss.n_node),
    };
  const box = [0, 1, 2].map((k) => range(target.filter((_, i) => i % 3 === k)));
  const centre = box.map(([a, b]) => (a + b) / 2),
    radius = Math.hypot(...box.map(([a, b]) => b - a)) / 2 || 1;
  // A cable can belong to several sets. It is hidden when one of them is off, and has the colour of the smallest.
  const setsOf = Array.from({ length: m }, () => []);
  net.sets.forEach((set, k) => set.cable.forEach((e) => setsOf[e].push(k)));
  const familyOf = setsOf.map((sets) => sets.sort((a, b) => net.sets[a].cable.length - net.sets[b].cable.length)[0]);
  const supports = Array.from({ length: n }, (_, i) => i).filter((i) => digit(net.role, i) === 0),
    isHeavy = m > MANY_LINES;
  // The visible cables in the order of their batches, with their ends; batch k begins at start[k].
  const order = new Int32Array(m),
    first = new Int32Array(m),
    second = new Int32Array(m),
    batchOf = new Int32Array(m),
    hasVisible = new Uint8Array(n); // nodes with a visible cable
  let overlays = [], // { at, x, y, colour }
    batches = [], // { colour, width }
    start = new Int32Array(1),
    nVisible = 0;
  const ink = {};
  const still = document.createElement("canvas"); // the picture without marks
  let fast = null; // the picture of a large net while it is turned
  const camera = { fit: 1, ax: 0, ay: 0, bx: 0, by: 0, bz: 0, x0: 0, y0: 0 };
  let queued = false,
    isStale = true, // the drawn objects have changed, not only the direction
    isStill = false,
    resting = 0,
    width = 0,
    height = 0;

  // ---- what is drawn, and in which colours ----

  // Sets positions with displacements d multiplied by the scale, three numbers for each.
  function displace(at, from, d) {
    for (let k = 0; k < at.length; k++) at[k] = from[k] + (d ? state.scale * d[k] : 0);
  }

  const isRounding = () => state.colour === "deviation" && innerMost(state.shape.distance_mm) < RESOLVED_MM;
  // Returns the value that the colour of a cable shows. limits() returns the range of these values.
  function valueOf(e) {
    const shape = state.shape;
    if (state.colour === "tension") return shape.tension_N[e];
    return (shape.distance_mm[end[2 * e]] + shape.distance_mm[end[2 * e + 1]]) / 2;
  }
  function limits() {
    if (state.colour === "tension")
      return widened(range(state.shape.tension_N.filter((_, e) => batchOf[e] >= 0)) || [0, 1]);
    return [0, innerMost(state.shape.distance_mm)];
  }

  // Returns the batches for the present colours, and a function from a cable to its batch.
  function colourRule() {
    const shape = state.shape,
      thin = isHeavy ? 1 : 1.7;
    const line = (colour, width = thin) => ({ colour, width });
    if (!shape) return [[line(ink.ghost, 0.8)], () => 0];
    if (state.colour === "plain") return [[line(ink.one)], () => 0];
    if (state.colour === "family")
      return [
        [line(ink.ghost), ...net.sets.map((_, k) => line(familyColour(k)))],
        (e) => (familyOf[e] === undefined ? 0 : 1 + familyOf[e]),
      ];
    if (state.colour === "adjustments")
      return [[line(ink.ghost), line(ink.alarm, 3.2)], (e) => (adjustmentOf.has(e) ? 1 : 0)];
    if (state.colour === "slack") return [[line(ink.ghost), line(ink.alarm, 3.2)], (e) => (shape.isSlack(e) ? 1 : 0)];
    const limit = limits(),
      least = state.colour !== "deviation" ? -Infinity : isRounding() ? Infinity : RESOLVED_MM; // below: no colour
    return [
      [line(ink.soft), ...levels(sequential).map((colour) => line(rgb(colour)))],
      (e) => (valueOf(e) < least ? 0 : 1 + levelOf(valueOf(e), limit)),
    ];
  }

  function sortIntoBatches() {
    hasVisible.fill(0);
    for (let e = 0; e < m; e++) {
      batchOf[e] = setsOf[e].some((k) => state.off.has(net.sets[k].name)) ? -1 : 0;
      if (batchOf[e] === 0) hasVisible[end[2 * e]] = hasVisible[end[2 * e + 1]] = 1;
    }
    const [lines, batch] = colourRule();
    batches = lines;
    start = new Int32Array(lines.length + 1);
    for (let e = 0; e < m; e++) {
      if (batchOf[e] < 0) continue;
      batchOf[e] = batch(e);
      start[batchOf[e] + 1]++;
    }
    for (let k = 0; k < lines.length; k++) start[k + 1] += start[k];
    const next = start.slice();
    for (let e = 0; e < m; e++) {
      if (batchOf[e] < 0) continue;
      const at = next[batchOf[e]]++;
      order[at] = e;
      first[at] = end[2 * e];
      second[at] = end[2 * e + 1];
    }
    nVisible = start[lines.length];
  }

  // Load cases are displaced from the shape that is drawn, because their displacements are often much smaller than its
  // deviations from the target positions. All have the same factor.
  function prepareOverlays(shape) {
    const moves = state.overlay.map(({ displacement_m: d }) =>
        d.map((v, k) => v - (shape ? shape.displacement_m[k] : 0)),
      ),
      factor = SCALES[scaleWithin(Math.max(0, ...moves.flatMap((d) => range(d).map(Math.abs))), radius)];
    overlays = moves.map((d, k) => ({
      at: drawn.at.map((v, i) => v + factor * d[i]),
      x: new Float32Array(n),
      y: new Float32Array(n),
      colour: css(state.overlay[k].colour),
    }));
    overlayLabel(state.overlay, factor);
  }

  function prepare() {
    const shape = state.shape;
    for (const name of ["ink", "soft", "ghost", "one", "four", "alarm"]) ink[name] = css(`--${name}`);
    displace(drawn.at, target, shape && shape.displacement_m);
    prepareOverlays(shape);
    if (truss) displace(beams.at, truss.position_m, shape && (shape.truss_displacement_m || truss.displacement_m));
    sortIntoBatches();
    drawLegend();
    isStale = false;
  }

  // ---- positions on the screen ----

  function aim() {
    const a = (view.yaw * Math.PI) / 180,
      b = (view.pitch * Math.PI) / 180,
      fit = (0.5 * Math.min(width, height) * view.zoom) / radius;
    camera.fit = fit;
    camera.ax = fit * Math.cos(a);
    camera.ay = fit * Math.sin(a);
    camera.bx = fit * Math.sin(a) * Math.sin(b);
    camera.by = -fit * Math.cos(a) * Math.sin(b);
    camera.bz = -fit * Math.cos(b);
    camera.x0 = width / 2 + view.panX - camera.ax * centre[0] - camera.ay * centre[1];
    camera.y0 = height / 2 + view.panY - camera.bx * centre[0] - camera.by * centre[1] - camera.bz * centre[2];
  }
  function project({ at, x, y }) {
    const { ax, ay, bx, by, bz, x0, y0 } = camera;
    for (let i = 0; i < x.length; i++) {
      x[i] = x0 + ax * at[3 * i] + ay * at[3 * i + 1];
      y[i] = y0 + bx * at[3 * i] + by * at[3 * i + 1] + bz * at[3 * i + 2];
    }
  }

  // Sets the zoom at which net and truss fill the picture, seen from the present direction.
  function fitZoom() {
    Object.assign(view, { zoom: 1, panX: 0, panY: 0 });
    aim();
    let u = 1,
      v = 1;
    for (const part of beams && state.truss ? [ghost, beams] : [ghost]) {
      project(part);
      for (const x of part.x) u = Math.max(u, Math.abs(x - width / 2));
      for (const y of part.y) v = Math.max(v, Math.abs(y - height / 2));
    }
    view.zoom = Math.min((width / 2 - 30) / u, (height / 2 - 34) / v);
  }

  // ---- drawing ----

  function strokePart(c, from, to, { x, y }) {
    c.beginPath();
    for (let k = from; k < to; k++) {
      c.moveTo(x[first[k]], y[first[k]]);
      c.lineTo(x[second[k]], y[second[k]]);
    }
    c.stroke();
  }
  function strokeCable(c, e, { x, y }) {
    c.beginPath();
    c.moveTo(x[end[2 * e]], y[end[2 * e]]);
    c.lineTo(x[end[2 * e + 1]], y[end[2 * e + 1]]);
    c.stroke();
  }

  function drawTruss(c) {
    const { x, y } = beams;
    c.strokeStyle = ink.four;
    c.globalAlpha = 0.7;
    c.lineWidth = 1.1;
    c.beginPath();
    for (let k = 0; k < truss.n_member; k++) {
      c.moveTo(x[truss.end[2 * k]], y[truss.end[2 * k]]);
      c.lineTo(x[truss.end[2 * k + 1]], y[truss.end[2 * k + 1]]);
    }
    c.stroke();
    c.globalAlpha = 1;
  }

  function drawCables(c) {
    for (let k = 0; k < batches.length; k++) {
      if (start[k] === start[k + 1]) continue;
      c.strokeStyle = batches[k].colour;
      c.lineWidth = batches[k].width;
      strokePart(c, start[k], start[k + 1], drawn);
    }
  }
  // Draws the cables in lines of one pixel, while the net is turned.
  function drawFast(c) {
    if (!fast || fast.width !== canvas.width || fast.height !== canvas.height)
      fast = linePicture(c, canvas.width, canvas.height);
    fast.clear();
    for (let k = 0; k < batches.length; k++)
      if (start[k] < start[k + 1]) fast.lines(batches[k].colour, start[k], start[k + 1], first, second, drawn);
    fast.show();
  }

  function drawSupports(c) {
    const side = n > 1000 ? 1.5 : 3;
    c.fillStyle = ink.ink;
    for (const i of supports) if (hasVisible[i]) c.fillRect(drawn.x[i] - side, drawn.y[i] - side, 2 * side, 2 * side);
  }

  function drawMarks(c) {
    if (state.chosen >= 0) {
      c.strokeStyle = ink.alarm;
      c.lineWidth = 5;
      strokeCable(c, state.chosen, drawn);
    }
    if (!state.picked) return;
    const { kind, index } = state.picked;
    c.strokeStyle = ink.ink;
    c.lineWidth = kind === "node" ? 2 : 4;
    if (kind === "cable") return strokeCable(c, index, drawn);
    c.beginPath();
    c.arc(drawn.x[index], drawn.y[index], 7, 0, 7);
    c.stroke();
  }

  function drawArm(c, name, dx, dy) {
    const length = 26 / camera.fit,
      x0 = 42,
      y0 = height - 42;
    if (Math.hypot(dx, dy) * length < 4) return;
    c.beginPath();
    c.moveTo(x0, y0);
    c.lineTo(x0 + length * dx, y0 + length * dy);
    c.stroke();
    c.fillText(name, x0 + 1.4 * length * dx, y0 + 1.4 * length * dy);
  }
  function drawAxes(c) {
    c.strokeStyle = c.fillStyle = ink.soft;
    c.lineWidth = 1.2;
    c.font = "12px system-ui, sans-serif";
    c.textAlign = "center";
    c.textBaseline = "middle";
    drawArm(c, "x", camera.ax, camera.bx);
    drawArm(c, "y", camera.ay, camera.by);
    drawArm(c, "z", 0, camera.bz);
  }

  function drawAll(c, isFast) {
    if (view.fitted) fitZoom();
    aim();
    project(drawn);
    c.clearRect(0, 0, width, height);
    c.lineCap = isHeavy ? "butt" : "round";
    if (isFast) drawFast(c);
    if (truss && state.truss) {
      project(beams);
      drawTruss(c);
    }
    if (state.target && state.shape && !isFast) {
      project(ghost);
      c.strokeStyle = ink.ghost;
      c.lineWidth = 0.8;
      strokePart(c, 0, nVisible, ghost);
    }
    if (!isFast) drawCables(c);
    for (const part of isFast ? [] : overlays) {
      project(part);
      c.strokeStyle = part.colour;
      c.lineWidth = 1.3;
      strokePart(c, 0, nVisible, part);
    }
    if (!isFast || supports.length < MANY_LINES / 10) drawSupports(c);
    drawAxes(c);
  }

  // isFast: a net of many lines is being turned.
  function draw(isFast) {
    width = canvas.clientWidth;
    height = canvas.clientHeight;
    if (!width || !height) return;
    const ratio = printing.matches ? 3 : isFast ? 1 : Math.max(1, devicePixelRatio || 1),
      c = canvas.getContext("2d"),
      across = Math.round(width * ratio),
      down = Math.round(height * ratio);
    if (canvas.width !== across || canvas.height !== down) {
      Object.assign(canvas, { width: across, height: down });
      isStill = false;
    }
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (isStale) {
      prepare();
      isStill = false;
    }
    if (isStill) {
      c.clearRect(0, 0, width, height);
      c.drawImage(still, 0, 0, width, height);
    } else {
      drawAll(c, isFast);
    }
    if (!isStill && !isFast) {
      Object.assign(still, { width: across, height: down });
      still.getContext("2d").drawImage(canvas, 0, 0);
      isStill = true;
    }
    drawMarks(c);
    showTip();
  }
  function drawNow() {
    isStale = true;
    draw(false);
  }
  function onFrame() {
    queued = false;
    draw(isHeavy && resting !== 0);
  }
  const request = () => {
    if (!queued) requestAnimationFrame(onFrame);
    queued = true;
  };
  function rest() {
    resting = 0;
    isStill = false;
    request();
  }
  // Redraws the net from another direction.
  function move() {
    isStill = false;
    if (isHeavy) {
      clearTimeout(resting);
      resting = setTimeout(rest, REST_MS);
    }
    request();
  }
  // Redraws the net after a change of its contents.
  function redraw() {
    isStale = true;
    request();
  }

  function drawLegend() {
    scaleLabel(state.scale);
    if (!state.shape || state.colour === "plain") return bar.replaceChildren();
    if (state.colour === "slack") {
      const k = Array.from({ length: m }, (_, e) => e).filter(state.shape.isSlack).length;
      return bar.replaceChildren(
        el("span", {}, `${k} of ${m} cables slack: tension below ${fmt(data.slack_below_N, 3)} N`),
      );
    }
    if (state.colour === "adjustments")
      return bar.replaceChildren(
        el("span", {}, `${fmtCount(adjustmentOf.size)} of ${fmtCount(m)} cables have a turnbuckle adjustment`),
      );
    if (state.colour === "family")
      return bar.replaceChildren(
        ...net.sets
          .map((set, k) => [set.name, familyColour(k)])
          .filter(([name]) => !state.off.has(name))
          .map(([name, colour]) => colourKey(colour, familyName(name))),
      );
    if (state.colour === "tension") drawBar(bar, sequential, limits(), "tension (N)");
    else drawBar(bar, sequential, limits(), "distance to target position (mm)", range(state.shape.distance_mm));
    if (isRounding()) bar.replaceChildren(roundingNote(outerMost(state.shape.distance_mm)));
  }

  // ---- the object under the pointer, and its values ----

  function segmentDistance(x, y, e) {
    const ax = drawn.x[end[2 * e]],
      ay = drawn.y[end[2 * e]],
      bx = drawn.x[end[2 * e + 1]] - ax,
      by = drawn.y[end[2 * e + 1]] - ay;
    const t = Math.max(0, Math.min(1, ((x - ax) * bx + (y - ay) * by) / (bx * bx + by * by || 1)));
    return Math.hypot(x - ax - t * bx, y - ay - t * by);
  }
  function pick(x, y) {
    let best = null,
      nearest = 9;
    for (let i = 0; i < n; i++) {
      const d = hasVisible[i] ? Math.hypot(drawn.x[i] - x, drawn.y[i] - y) : Infinity;
      if (d < nearest) [nearest, best] = [d, { kind: "node", index: i }];
    }
    if (best) return best;
    nearest = 6;
    for (let k = 0; k < nVisible; k++) {
      const e = order[k];
      const d = segmentDistance(x, y, e);
      if (d < nearest) [nearest, best] = [d, { kind: "cable", index: e }];
    }
    return best;
  }

  function describeNode(i) {
    const t = Array.from(target.slice(3 * i, 3 * i + 3)),
      shape = state.shape,
      d = shape ? shape.displacement_m : [];
    const at = t.map((v, k) => fmt(v + (shape ? d[3 * i + k] : 0), 6)).join(", ");
    const rows = [
      ["role", roleOf(i), ""],
      ["position", `${at} m`, "position_m"],
    ];
    if (shape)
      rows.push(
        ["to target position", `${fmt(shape.distance_mm[i], 5)} mm`, ""],
        ["Δx, Δy, Δz", `${[0, 1, 2].map((k) => fmt(1e3 * d[3 * i + k], 4)).join(", ")} mm`, ""],
      );
    return tipContent(`node ${net.node_id[i]}`, rows);
  }
  function describeCable(e) {
    const shape = state.shape,
      rows = [["group", groupOf(e), ""]];
    if (setsOf[e].length) rows.push(["sets", setsOf[e].map((k) => net.sets[k].name).join(", "), ""]);
    if (adjust)
      rows.push([
        "estimated length error",
        `${inMm(Math.abs(adjust.error_m[e]), 3)} ${tooWhat(adjust.error_m[e])}`,
        "",
      ]);
    if (adjustmentOf.has(e))
      rows.push(["turnbuckle adjustment", `${signed(1e3 * adjustmentOf.get(e).turnbuckle_m)} mm`, ""]);
    if (shape)
      rows.push(
        ["tension", `${fmt(shape.tension_N[e], 6)} N${shape.isSlack(e) ? ", slack" : ""}`, "tension_N"],
        ["length", `${fmt(shape.length_m[e], 6)} m`, "length_m"],
        ["force density", `${fmt(shape.tension_N[e] / shape.length_m[e], 6)} N/m`, "q_N_per_m"],
        ["law in force", net.law_word[digit(shape.law, e)].replace("_", " "), "law"],
      );
    return tipContent(`cable ${net.cable_id[e]}`, rows);
  }
  function showTip() {
    if (!state.picked) {
      tip.hidden = true;
      return;
    }
    const { kind, index } = state.picked,
      [x, y] = screenOf(kind, index);
    placeTip(tip, x, y, kind === "node" ? describeNode(index) : describeCable(index));
  }
  function screenOf(kind, index) {
    if (kind === "node") return [drawn.x[index], drawn.y[index]];
    const [i, j] = [end[2 * index], end[2 * index + 1]];
    return [(drawn.x[i] + drawn.x[j]) / 2, (drawn.y[i] + drawn.y[j]) / 2];
  }
  function select(picked) {
    const same = state.picked && picked && state.picked.kind === picked.kind && state.picked.index === picked.index;
    if (same || (!state.picked && !picked)) return;
    state.picked = picked;
    request();
  }

  // Selects a cable from the table, or none with -1.
  function choose(e) {
    state.chosen = e;
    state.picked = null;
    if (e >= 0) state.picked = { kind: "cable", index: e };
    request();
  }
  function chooseFound() {
    const e = state.picked && state.picked.kind === "cable" ? state.picked.index : -1;
    state.chosen = e;
    if (handle.onChoose) handle.onChoose(e);
    request();
  }

  function turn(yaw, pitch) {
    view.fitted = false;
    view.yaw = (view.yaw + yaw) % 360;
    view.pitch = Math.max(-90, Math.min(90, view.pitch + pitch));
    move();
  }
  function pan(dx, dy) {
    view.fitted = false;
    view.panX += dx;
    view.panY += dy;
    move();
  }
  // Zooms about a point of the picture, which keeps its position.
  function zoom(factor, x = width / 2, y = height / 2) {
    const before = view.zoom;
    view.fitted = false;
    view.zoom = Math.max(0.05, Math.min(100, view.zoom * factor));
    const k = view.zoom / before;
    view.panX = (view.panX + width / 2 - x) * k + x - width / 2;
    view.panY = (view.panY + height / 2 - y) * k + y - height / 2;
    move();
  }
  function look(yaw, pitch) {
    Object.assign(view, { yaw, pitch, fitted: true });
    isStill = false;
    request();
  }
  function step(kind, by) {
    const count = kind === "node" ? n : m,
      at = state.picked && state.picked.kind === kind ? state.picked.index : -1;
    select({ kind, index: at < 0 ? (by > 0 ? 0 : count - 1) : (at + by + count) % count });
  }

  netHand(canvas, { turn, pan, zoom, look, step, pick, select, chooseFound });
  new ResizeObserver(rest).observe(canvas);
  darkScheme.addEventListener("change", redraw);
  printing.addEventListener("change", drawNow);
  addEventListener("beforeprint", drawNow);
  addEventListener("afterprint", redraw);
  const handle = { state, view, redraw, zoom, look, screenOf, radius, choose };
  return handle;
}
