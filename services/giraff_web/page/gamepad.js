// Gamepads, as the browser tells of them in each animation frame, to the hand: a shoulder button is the dead-man's
// switch, the left stick drives, and B stops.

import { PAD_FULL, padShare } from "./hand.js";
import { place } from "./pad.js";
import { write } from "./panel.js";

/** Buttons of the standard mapping: B or circle, LB or L1, RB or R1. */
const STOP = 1;
const SWITCHES = [4, 5];

/** One axis as a share of full speed: the pad's curve, so that a quarter of the stick's way asks nothing. */
export const stickShare = (axis) => padShare(axis, 1 / PAD_FULL);

/** Read one gamepad; null: nobody knows its buttons. Its stop counts even where its stick says no number. */
export function read(pad) {
  if (!pad?.connected || pad.mapping !== "standard" || pad.buttons.length <= Math.max(...SWITCHES)) return null;
  const [x, y] = pad.axes;
  const isHand = Number.isFinite(x) && Number.isFinite(y);
  return {
    isHand,
    held: SWITCHES.some((each) => pad.buttons[each].pressed),
    stop: pad.buttons[STOP].pressed,
    asks: isHand ? [stickShare(-y), stickShare(-x)] : [0, 0],
    // Not its timestamp: some systems renew that with each look, others only when something moves.
    state: [...pad.axes, ...pad.buttons.map((button) => button.value)].join(),
  };
}

/** What is written on the field. */
export function padText(pads) {
  const connected = pads.filter((pad) => pad?.connected);
  if (connected.some(read)) return "Hold LB or RB (L1, R1), drive with the left stick. B (circle) stops.";
  if (!connected.length) return "No gamepad is heard: plug it in and press one of its buttons.";
  return `This browser does not know the buttons of ${connected[0].id}, and none of them stops: use another one.`;
}

export class Gamepads {
  /**
   * @param {import("./hand.js").Hand} hand
   * @param {{press: () => void}} stop
   */
  constructor(hand, stop) {
    this._hand = hand;
    this._stop = stop;
    /** As they were in the last frame. Another one on the same place has another name. */
    this._known = new Map();
    this._lookedAt = -Infinity;
    /** Name of the one whose switch began the newest hold. */
    this._holder = "";
  }

  /** Take all gamepads, before the hand's own frame. A switch that is down at the first look was pressed for nothing. */
  onFrame(pads, now) {
    const known = new Map();
    const stops = pads.some((pad) => read(pad)?.stop); // whoever stops begins no hold, with any gamepad
    for (const pad of pads) {
      const is = read(pad);
      if (!is) continue;
      const name = `${pad.index} ${pad.id}`;
      const was = this._known.get(name);
      known.set(name, is);
      if (is.stop && !was?.stop) this._stop.press();
      if (stops || !is.isHand || !is.held || !was?.isHand || was.held) continue;
      const centred = is.asks.every((share) => share === 0);
      // It was pressed after the last look, and nobody knows when.
      if (this._hand.onSwitchDown(centred, this._lookedAt, now)) this._holder = name;
    }
    const holder = known.get(this._holder);
    if (!holder?.isHand) this._hand.onGamepadGone();
    else if (!holder.held) this._hand.onSwitchUp();
    else this._hand.onStick(holder.asks, holder.state !== this._known.get(this._holder)?.state, now);
    this._known = known;
    this._lookedAt = now;
  }
}

/**
 * Draw what the stick asks.
 * @param {HTMLElement} field
 * @param {import("./hand.js").Hand} hand
 */
export function draw(field, hand, pads) {
  field.classList.toggle("held", hand.hold > 0);
  const [text, ring, knob] = /** @type {any} */ (field.children);
  write(text, padText(pads));
  const { clientWidth: width, clientHeight: height } = field;
  const most = PAD_FULL * Math.min(width, height);
  const [forward, left] = hand.asks;
  ring.style.width = ring.style.height = `${2 * most}px`;
  place(ring, width / 2, height / 2);
  place(knob, width / 2 - left * most, height / 2 - forward * most);
}
