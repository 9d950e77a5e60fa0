// The keyboard: drive keys to the hand, SPACE to the stop wherever the focus is.

const seconds = (event) => event.timeStamp / 1000;

/** The keys of a screen have no code. */
const isSpace = (event) => event.code === "Space" || event.key === " ";

/** Where keys mean something else: a form field, the choice of the input, an open question. */
function isTaken(target, code) {
  if (!(target instanceof Element)) return false;
  if (target.closest("input, textarea, select, [contenteditable], dialog")) return true;
  return code.startsWith("Arrow") && target.closest("[role=radiogroup]") !== null;
}

/**
 * @param {import("./hand.js").Hand} hand
 * @param {{press: () => void, hold: () => void, letGo: () => void}} stop
 * @param {() => number} clock s
 */
export function listen(hand, stop, clock) {
  addEventListener(
    "keydown",
    (event) => {
      if (isSpace(event)) {
        event.preventDefault(); // it never also presses a button, nor scrolls
        event.stopPropagation();
        if (!event.repeat) {
          stop.press();
          stop.hold();
        }
        return;
      }
      if (event.ctrlKey || event.altKey || event.metaKey || isTaken(event.target, event.code)) return;
      if (hand.onKeyDown(event.code, event.repeat, seconds(event), clock())) event.preventDefault();
    },
    { capture: true },
  );
  addEventListener(
    "keyup",
    (event) => {
      if (isSpace(event)) {
        event.preventDefault(); // Firefox presses buttons here
        stop.letGo();
      }
      hand.onKeyUp(event.code, clock());
    },
    { capture: true },
  );
}

/**
 * Light up the keys that count.
 * @param {HTMLElement} panel
 * @param {import("./hand.js").Hand} hand
 */
export function draw(panel, hand) {
  panel.classList.toggle("held", hand.hold > 0);
  for (const cap of panel.querySelectorAll("[data-codes]")) {
    const codes = /** @type {HTMLElement} */ (cap).dataset.codes?.split(" ") ?? [];
    cap.classList.toggle("down", codes.some((code) => hand.pressed.has(code)));
  }
}
