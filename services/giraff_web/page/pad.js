// A field on which a finger holds: events to the hand, and where the finger is.

const seconds = (event) => event.timeStamp / 1000;

/**
 * @param {HTMLElement} field
 * @param {import("./hand.js").Hand} hand
 * @param {() => number} clock s
 */
export function listen(field, hand, clock) {
  field.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    const box = field.getBoundingClientRect();
    const holds = hand.onPointerDown(
      {
        id: event.pointerId,
        kind: event.pointerType,
        primary: event.isPrimary,
        button: event.button,
        x: event.clientX,
        y: event.clientY,
        side: Math.min(box.width, box.height),
        when: seconds(event),
      },
      clock(),
    );
    if (!holds) return;
    try {
      field.setPointerCapture(event.pointerId);
    } catch {
      hand.onPointerLost(event.pointerId, false); // it is gone already
    }
  });
  field.addEventListener("pointermove", (event) => {
    // With another button down, the left one's lifting is told as a move.
    if ((event.buttons & 1) === 0) hand.onPointerUp(event.pointerId);
    else hand.onPointerMove(event.pointerId, event.clientX, event.clientY, seconds(event), clock());
  });
  field.addEventListener("pointerup", (event) => hand.onPointerUp(event.pointerId));
  field.addEventListener("pointercancel", (event) => hand.onPointerLost(event.pointerId, false));
  field.addEventListener("lostpointercapture", (event) => hand.onPointerLost(event.pointerId, true));
  for (const name of ["contextmenu", "dragstart", "selectstart"]) {
    field.addEventListener(name, (event) => event.preventDefault());
  }
  // Safari zooms by these, whatever touch-action says.
  for (const name of ["touchstart", "touchmove", "gesturestart"]) {
    field.addEventListener(name, (event) => event.preventDefault(), { passive: false });
  }
}

/**
 * Draw where the finger was put and where it is.
 * @param {HTMLElement} field
 * @param {HTMLElement} ring
 * @param {HTMLElement} knob
 * @param {import("./hand.js").Hand} hand
 */
export function draw(field, ring, knob, hand) {
  const finger = hand.finger;
  field.classList.toggle("held", hand.hold > 0);
  if (!finger) return;
  const box = field.getBoundingClientRect();
  const most = 0.4 * finger.side;
  const [dx, dy] = [finger.x - finger.x0, finger.y - finger.y0];
  const limit = Math.min(1, most / Math.max(1, Math.hypot(dx, dy)));
  ring.style.width = ring.style.height = `${2 * most}px`;
  place(ring, finger.x0 - box.left, finger.y0 - box.top);
  place(knob, finger.x0 - box.left + dx * limit, finger.y0 - box.top + dy * limit);
}

export function place(mark, x, y) {
  mark.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
}
