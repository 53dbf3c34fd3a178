// ---- families: sets of cables ----

const familyName = (name) => name.replace(/_/g, " ");
// Colours around the circle of hues, as light as each other.
const familyColour = (k) => rgb(oklch(isDark() ? 0.75 : 0.55, 0.14, 250 + (360 * k) / net.sets.length));

// Draws the net in space. Dragging or the arrow keys turn it. Lines of one colour are drawn in one call.

function netView({ canvas, tip, bar, scaleLabel }) {
  const view = { yaw: -35, pitch: 32, zoom: 1, panX: 0, panY: 0, fitted: true }; // fitted: the zoom follows the room
  const state = {
    shape: resultShape,
    colour: "deviation",
    scale: 1,
    theory: true,
    truss: !!data.truss,
    picked: null,
    chosen: -1, // the cable that was clicked, here or in the table
    off: new Set(), // sets of cables that are not drawn
  };
  const theory = data.net.position_m,
    n = net.n_node,
    m = net.n_cable,
    end = net.end;
  const truss = data.truss;
  const px = new Float64Array(n),
    py = new Float64Array(n),
    tx = new Float64Array(n),
    ty = new Float64Array(n);
  const box = [0, 1, 2].map((k) => range(theory.filter((_, i) => i % 3 === k)));
  const centre = box.map(([a, b]) => (a + b) / 2),
    radius = Math.hypot(...box.map(([a, b]) => b - a)) / 2 || 1;
  // A cable is in any number of sets: it is drawn unless one of them is off, and has the colour of the smallest.
  const setsOf = Array.from({ length: m }, () => []);
  net.sets.forEach((set, k) => set.cable.forEach((e) => setsOf[e].push(k)));
  const familyOf = setsOf.map((sets) => sets.sort((a, b) => net.sets[a].cable.length - net.sets[b].cable.length)[0]);
  let visible = [],
    isVisible = new Uint8Array(m),
    hasVisible = new Uint8Array(n), // nodes with a cable that is drawn
    queued = false,
    width = 0,
    height = 0;

  function chooseVisible() {
    visible = [];
    isVisible.fill(0);
    hasVisible.fill(0);
    for (let e = 0; e < m; e++) {
      if (setsOf[e].some((k) => state.off.has(net.sets[k].name))) continue;
      visible.push(e);
      isVisible[e] = hasVisible[end[2 * e]] = hasVisible[end[2 * e + 1]] = 1;
    }
  }

  function projection() {
    const a = (view.yaw * Math.PI) / 180,
      b = (view.pitch * Math.PI) / 180;
    const fit = (0.5 * Math.min(width, height) * view.zoom) / radius;
    const ux = [Math.cos(a), Math.sin(a), 0];
    const uy = [Math.sin(a) * Math.sin(b), -Math.cos(a) * Math.sin(b), -Math.cos(b)];
    return (x, y, z) => {
      const q = [x - centre[0], y - centre[1], z - centre[2]];
      return [
        width / 2 + view.panX + fit * (ux[0] * q[0] + ux[1] * q[1]),
        height / 2 + view.panY + fit * (uy[0] * q[0] + uy[1] * q[1] + uy[2] * q[2]),
      ];
    };
  }

  // The zoom at which net and truss, seen from the present direction, fill the picture.
  function fitZoom() {
    Object.assign(view, { zoom: 1, panX: 0, panY: 0 });
    const project = projection(),
      points = truss && state.truss ? [theory, truss.position_m] : [theory];
    let x = 1,
      y = 1;
    for (const p of points)
      for (let k = 0; k < p.length; k += 3) {
        const at = project(p[k], p[k + 1], p[k + 2]);
        x = Math.max(x, Math.abs(at[0] - width / 2));
        y = Math.max(y, Math.abs(at[1] - height / 2));
      }
    view.zoom = Math.min((width / 2 - 30) / x, (height / 2 - 34) / y);
  }

  function place() {
    if (view.fitted) fitZoom();
    const project = projection(),
      d = state.shape ? state.shape.displacement_m : null,
      s = state.scale;
    for (let i = 0; i < n; i++) {
      const p = theory.slice(3 * i, 3 * i + 3);
      [tx[i], ty[i]] = project(...p);
      [px[i], py[i]] = d
        ? project(p[0] + s * d[3 * i], p[1] + s * d[3 * i + 1], p[2] + s * d[3 * i + 2])
        : [tx[i], ty[i]];
    }
    return project;
  }

  // The value that a cable's colour shows, and the range of these values.
  function valueOf(e) {
    const shape = state.shape;
    if (state.colour === "tension") return shape.tension_N[e];
    return (shape.distance_mm[end[2 * e]] + shape.distance_mm[end[2 * e + 1]]) / 2;
  }
  function limits() {
    if (state.colour === "tension") return range(visible.map((e) => state.shape.tension_N[e])) || [0, 1];
    return [0, isRounding() ? range(state.shape.distance_mm)[1] : innerMost(state.shape.distance_mm)];
  }

  const isRounding = () => state.colour === "deviation" && innerMost(state.shape.distance_mm) < RESOLVED_MM;

  function strokeAll(c, list, x, y) {
    c.beginPath();
    for (const e of list) {
      c.moveTo(x[end[2 * e]], y[end[2 * e]]);
      c.lineTo(x[end[2 * e + 1]], y[end[2 * e + 1]]);
    }
    c.stroke();
  }

  function drawTruss(c, project) {
    const p = truss.position_m,
      d = state.shape && (state.shape.truss_displacement_m || truss.displacement_m),
      s = state.scale;
    const at = (i) => project(...[0, 1, 2].map((k) => p[3 * i + k] + (d ? s * d[3 * i + k] : 0)));
    c.strokeStyle = css("--four");
    c.globalAlpha = 0.7;
    c.lineWidth = 1.1;
    c.beginPath();
    for (let k = 0; k < truss.n_member; k++) {
      c.moveTo(...at(truss.end[2 * k]));
      c.lineTo(...at(truss.end[2 * k + 1]));
    }
    c.stroke();
    c.globalAlpha = 1;
  }

  function drawCables(c) {
    const shape = state.shape;
    c.lineWidth = m > 3000 ? 1.1 : 1.7;
    if (!shape || state.colour === "plain") {
      c.strokeStyle = css("--one");
      strokeAll(c, visible, px, py);
    } else if (state.colour === "family") {
      for (const k of [undefined, ...net.sets.keys()]) {
        c.strokeStyle = k === undefined ? css("--ghost") : familyColour(k);
        strokeAll(
          c,
          visible.filter((e) => familyOf[e] === k),
          px,
          py,
        );
      }
    } else if (state.colour === "slack") {
      c.strokeStyle = css("--ghost");
      strokeAll(
        c,
        visible.filter((e) => !shape.isSlack(e)),
        px,
        py,
      );
      c.strokeStyle = css("--alarm");
      c.lineWidth = 3.2;
      strokeAll(c, visible.filter(shape.isSlack), px, py);
    } else {
      const limit = limits(),
        bucket = Array.from({ length: LEVELS }, () => []),
        isNone = (v) => state.colour === "deviation" && v < RESOLVED_MM;
      c.strokeStyle = css("--soft");
      strokeAll(
        c,
        visible.filter((e) => isNone(valueOf(e))),
        px,
        py,
      );
      for (const e of visible) if (!isNone(valueOf(e))) bucket[levelOf(valueOf(e), limit)].push(e);
      levels(sequential).forEach((colour, k) => {
        if (!bucket[k].length) return;
        c.strokeStyle = rgb(colour);
        strokeAll(c, bucket[k], px, py);
      });
    }
  }

  function drawNodes(c) {
    const side = n > 1000 ? 1.5 : 3;
    c.fillStyle = css("--ink");
    for (let i = 0; i < n; i++)
      if (digit(net.role, i) === 0 && hasVisible[i]) c.fillRect(px[i] - side, py[i] - side, 2 * side, 2 * side);
    if (state.chosen >= 0) {
      c.strokeStyle = css("--alarm");
      c.lineWidth = 5;
      strokeAll(c, [state.chosen], px, py);
    }
    if (!state.picked) return;
    const { kind, index } = state.picked;
    c.strokeStyle = css("--ink");
    c.lineWidth = kind === "node" ? 2 : 4;
    if (kind === "cable") return strokeAll(c, [index], px, py);
    c.beginPath();
    c.arc(px[index], py[index], 7, 0, 7);
    c.stroke();
  }

  function drawAxes(c) {
    const a = (view.yaw * Math.PI) / 180,
      b = (view.pitch * Math.PI) / 180,
      length = 26,
      x0 = 42,
      y0 = height - 42;
    const arms = [
      ["x", Math.cos(a), Math.sin(a) * Math.sin(b)],
      ["y", Math.sin(a), -Math.cos(a) * Math.sin(b)],
      ["z", 0, -Math.cos(b)],
    ];
    c.strokeStyle = c.fillStyle = css("--soft");
    c.lineWidth = 1.2;
    c.font = "12px system-ui, sans-serif";
    c.textAlign = "center";
    c.textBaseline = "middle";
    for (const [name, dx, dy] of arms) {
      if (Math.hypot(dx, dy) < 0.15) continue;
      c.beginPath();
      c.moveTo(x0, y0);
      c.lineTo(x0 + length * dx, y0 + length * dy);
      c.stroke();
      c.fillText(name, x0 + (length + 10) * dx, y0 + (length + 10) * dy);
    }
  }

  function draw() {
    queued = false;
    width = canvas.clientWidth;
    height = canvas.clientHeight;
    if (!width || !height) return;
    const ratio = printing.matches ? 3 : Math.max(1, devicePixelRatio || 1),
      c = canvas.getContext("2d");
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.lineCap = "round";
    const project = place();
    chooseVisible();
    if (truss && state.truss) drawTruss(c, project);
    if (state.theory || !state.shape) {
      c.strokeStyle = css("--ghost");
      c.lineWidth = 0.8;
      strokeAll(c, visible, tx, ty);
    }
    if (state.shape) drawCables(c);
    drawNodes(c);
    drawAxes(c);
    drawLegend();
    showTip();
  }
  const redraw = () => {
    if (!queued) requestAnimationFrame(draw);
    queued = true;
  };

  function drawLegend() {
    scaleLabel(state.scale);
    if (!state.shape || state.colour === "plain") return bar.replaceChildren();
    if (state.colour === "slack") {
      const k = Array.from({ length: m }, (_, e) => e).filter(state.shape.isSlack).length;
      return bar.replaceChildren(
        el("span", {}, `${k} of ${m} cables slack: tension below ${fmt(data.slack_below_N, 3)} N`),
      );
    }
    if (state.colour === "family")
      return bar.replaceChildren(
        ...net.sets
          .map((set, k) => [set.name, familyColour(k)])
          .filter(([name]) => !state.off.has(name))
          .map(([name, colour]) => {
            const swatch = el("span", { class: "swatch" });
            swatch.style.background = colour; // not an attribute: the rules of the page allow this alone
            return el("span", { class: "family" }, swatch, familyName(name));
          }),
      );
    if (state.colour === "tension") drawBar(bar, sequential, limits(), "tension (N)");
    else drawBar(bar, sequential, limits(), "distance to theory (mm)", range(state.shape.distance_mm));
    if (isRounding()) {
      if (limits()[1] < RESOLVED_MM) bar.replaceChildren();
      bar.append(roundingNote());
    }
  }

  // ---- what is under the pointer, and its values ----

  function segmentDistance(x, y, e) {
    const ax = px[end[2 * e]],
      ay = py[end[2 * e]],
      bx = px[end[2 * e + 1]] - ax,
      by = py[end[2 * e + 1]] - ay;
    const t = Math.max(0, Math.min(1, ((x - ax) * bx + (y - ay) * by) / (bx * bx + by * by || 1)));
    return Math.hypot(x - ax - t * bx, y - ay - t * by);
  }
  function pick(x, y) {
    let best = null,
      least = 9;
    for (let i = 0; i < n; i++) {
      const d = hasVisible[i] ? Math.hypot(px[i] - x, py[i] - y) : Infinity;
      if (d < least) [least, best] = [d, { kind: "node", index: i }];
    }
    if (best) return best;
    least = 6;
    for (const e of visible) {
      const d = segmentDistance(x, y, e);
      if (d < least) [least, best] = [d, { kind: "cable", index: e }];
    }
    return best;
  }

  function describeNode(i) {
    const t = theory.slice(3 * i, 3 * i + 3),
      shape = state.shape,
      d = shape ? shape.displacement_m : [];
    const at = t.map((v, k) => fmt(v + (shape ? d[3 * i + k] : 0), 6)).join(", ");
    const rows = [
      ["role", roleOf(i), ""],
      ["position", `${at} m`, "position_m"],
    ];
    if (shape)
      rows.push(
        ["to theory", `${fmt(shape.distance_mm[i], 5)} mm`, ""],
        ["Δx, Δy, Δz", `${[0, 1, 2].map((k) => fmt(1e3 * d[3 * i + k], 4)).join(", ")} mm`, ""],
      );
    return tipContent(`node ${net.node_id[i]}`, rows);
  }
  function describeCable(e) {
    const shape = state.shape,
      rows = [["group", groupOf(e), ""]];
    if (setsOf[e].length) rows.push(["sets", setsOf[e].map((k) => net.sets[k].name).join(", "), ""]);
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
    if (kind === "node") return [px[index], py[index]];
    const [i, j] = [end[2 * index], end[2 * index + 1]];
    return [(px[i] + px[j]) / 2, (py[i] + py[j]) / 2];
  }
  function select(picked) {
    const same = state.picked && picked && state.picked.kind === picked.kind && state.picked.index === picked.index;
    if (same || (!state.picked && !picked)) return;
    state.picked = picked;
    redraw();
  }

  // Marks a cable for good: view.onChoose tells the table.
  function choose(e) {
    state.chosen = e;
    state.picked = null;
    if (e >= 0) state.picked = { kind: "cable", index: e };
    redraw();
  }
  function chooseFound() {
    const e = state.picked && state.picked.kind === "cable" ? state.picked.index : -1;
    state.chosen = e;
    if (handle.onChoose) handle.onChoose(e);
    redraw();
  }

  // ---- pointer and keys ----

  const pointers = new Map();
  let pinch = 0,
    dragged = false;
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    dragged = false;
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add("dragging");
    if (pointers.size === 2) pinch = spread();
  });
  canvas.addEventListener("pointermove", (event) => {
    const at = pointers.get(event.pointerId),
      frame = canvas.getBoundingClientRect();
    if (!at) return select(pick(event.clientX - frame.left, event.clientY - frame.top));
    dragged = true;
    const dx = event.clientX - at.x,
      dy = event.clientY - at.y;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 2) {
      zoom(spread() / pinch);
      pinch = spread();
    } else if (event.shiftKey || event.buttons === 2) pan(dx, dy);
    else turn(0.4 * dx, 0.4 * dy);
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => {
      const frame = canvas.getBoundingClientRect();
      pointers.delete(event.pointerId);
      canvas.classList.remove("dragging");
      if (dragged) return;
      select(pick(event.clientX - frame.left, event.clientY - frame.top)); // a tap or click
      chooseFound();
    });
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType !== "touch") select(null);
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const frame = canvas.getBoundingClientRect();
      zoom(Math.exp(-0.0015 * event.deltaY), event.clientX - frame.left, event.clientY - frame.top);
    },
    { passive: false },
  );

  function turn(yaw, pitch) {
    view.fitted = false;
    view.yaw = (view.yaw + yaw) % 360;
    view.pitch = Math.max(-90, Math.min(90, view.pitch + pitch));
    redraw();
  }
  function pan(dx, dy) {
    view.fitted = false;
    view.panX += dx;
    view.panY += dy;
    redraw();
  }
  // Zooms about a point of the picture: that point stays where it is.
  function zoom(factor, x = width / 2, y = height / 2) {
    const before = view.zoom;
    view.fitted = false;
    view.zoom = Math.max(0.05, Math.min(100, view.zoom * factor));
    const k = view.zoom / before;
    view.panX = (view.panX + width / 2 - x) * k + x - width / 2;
    view.panY = (view.panY + height / 2 - y) * k + y - height / 2;
    redraw();
  }
  function look(yaw, pitch) {
    Object.assign(view, { yaw, pitch, fitted: true });
    redraw();
  }
  function step(kind, by) {
    const count = kind === "node" ? n : m,
      at = state.picked && state.picked.kind === kind ? state.picked.index : -1;
    select({ kind, index: at < 0 ? (by > 0 ? 0 : count - 1) : (at + by + count) % count });
  }
  canvas.addEventListener("keydown", (event) => {
    const far = event.shiftKey,
      keys = {
        ArrowLeft: () => (far ? pan(-30, 0) : turn(-5, 0)),
        ArrowRight: () => (far ? pan(30, 0) : turn(5, 0)),
        ArrowUp: () => (far ? pan(0, -30) : turn(0, -5)),
        ArrowDown: () => (far ? pan(0, 30) : turn(0, 5)),
        "+": () => zoom(1.2),
        "=": () => zoom(1.2),
        "-": () => zoom(1 / 1.2),
        0: () => look(-35, 32),
        n: () => step("node", 1),
        N: () => step("node", -1),
        c: () => step("cable", 1),
        C: () => step("cable", -1),
        Enter: chooseFound,
        Escape: () => select(null),
      };
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });

  new ResizeObserver(redraw).observe(canvas);
  darkScheme.addEventListener("change", redraw);
  printing.addEventListener("change", draw);
  addEventListener("beforeprint", draw);
  addEventListener("afterprint", redraw);
  const handle = { state, view, redraw, zoom, look, screenOf, radius, choose };
  return handle;
}
