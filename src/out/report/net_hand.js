// Handles pointer, touch and keys for the net in space.

function netHand(canvas, { turn, pan, zoom, look, step, pick, select, chooseFound }) {
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
}
