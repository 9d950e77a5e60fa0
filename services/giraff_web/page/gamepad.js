// Gamepads, as the browser tells of them in each animation frame, to the hand: a shoulder button is the dead-man's
// switch, the left stick drives, and each of the four buttons on the right stops.

import { PAD_FULL, padShare } from "./hand.js";
import { place } from "./pad.js";
import { write } from "./panel.js";

/** Buttons of the standard mapping, which goes by position. The letter on each depends on the maker. */
const STOPS = [0, 1, 2, 3];
const SWITCHES = [4, 5];
/** Number of axes and buttons of that mapping. Further ones, as a gyro's, tell nothing of a hand. */
const AXES = 4;
const BUTTONS = 17;
/** s. A gamepad that only swaps between two values of one axis for so long is in no hand: it may be out of reach. */
export const SWAPS = 3.0;

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
    stops: STOPS.filter((each) => pad.buttons[each].pressed),
    asks: isHand ? [stickShare(-y), stickShare(-x)] : [0, 0],
    // Not its timestamp: some systems renew that with each look, others only when something moves.
    state: [...pad.axes.slice(0, AXES), ...pad.buttons.slice(0, BUTTONS).map((button) => button.value)],
  };
}

/** Count the axes and buttons that differ. As text: not a number is like itself, and 0 is like -0. */
const changes = (one, other) => one.filter((value, n) => String(value) !== String(other[n])).length;

/** Tells a hand from a gamepad that only swaps between two values. One for each hold. */
class HandCheck {
  constructor() {
    /** The two newest states that differ, the newest first. */
    this._states = [];
    this._askedAt = -Infinity;
    this._handAt = -Infinity;
    /** Something has moved since the last frame. */
    this.moved = false;
    /** The gamepad may be in a hand. */
    this.isHand = true;
  }

  onFrame({ asks, state }, now) {
    const [last, before] = this._states.map((each) => changes(each, state));
    this.moved = last !== 0;
    const isNew = (this.moved && before !== 0) || last > 1;
    if (asks.some((share) => share !== 0)) this._askedAt = now;
    // A centred stick may rest. One that asks every now and then is not centred.
    if (isNew || now - this._askedAt >= SWAPS) this._handAt = now;
    if (this.moved) this._states = [state, ...this._states.slice(0, 1)];
    this.isHand = now - this._handAt < SWAPS;
  }
}

const HOW =
  "Hold an upper shoulder button, drive with the left stick. Any of the four round buttons on the right stops.";

/** What is written on the field. */
export function padText(pads) {
  const connected = pads.filter((pad) => pad?.connected);
  if (connected.some(read)) return HOW;
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
    this._check = new HandCheck();
  }

  /** Take all gamepads, before the hand's own frame. A switch that is down at the first look was pressed for nothing. */
  onFrame(pads, now) {
    const known = new Map();
    const stops = pads.some((pad) => read(pad)?.stops.length); // whoever stops begins no hold, with any gamepad
    for (const pad of pads) {
      const is = read(pad);
      if (!is) continue;
      const name = `${pad.index} ${pad.id}`;
      const was = this._known.get(name);
      known.set(name, is);
      if (is.stops.some((each) => !was?.stops.includes(each))) this._stop.press();
      if (stops || !is.isHand || !is.held || !was?.isHand || was.held) continue;
      const centred = is.asks.every((share) => share === 0);
      // It was pressed after the last look, and nobody knows when.
      if (!this._hand.onSwitchDown(centred, this._lookedAt, now)) continue;
      this._holder = name;
      this._check = new HandCheck();
    }
    const holder = known.get(this._holder);
    if (holder) this._check.onFrame(holder, now);
    if (!holder?.isHand || !this._check.isHand) this._hand.onGamepadGone();
    else if (!holder.held) this._hand.onSwitchUp();
    else this._hand.onStick(holder.asks, this._check.moved, now);
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
