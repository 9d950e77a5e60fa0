// What the hand on this page asks of the robot. No DOM and no clock: every time is an argument, in seconds of the
// page's own clock (performance.now() / 1000; an event's timeStamp / 1000).

/** s. An event that is older when it is handled was queued while the page stood still: it is none. */
export const EVENT_FRESH = 0.25;
/** s that a hold lasts without a pointer, key or motion event. */
export const IDLE = 1.0;
/** s between two animation frames, or two looks of the timer, from which the page has stood still. */
export const STALLED = 0.3;
/** s without a state after which the link is lost. */
export const LINK_LOST = 0.5;
/** s at least between two wishes that hold nothing of a page that does not drive. */
export const IDLE_WISH = 0.1;
/** s at least between two wishes: a screen of 120 Hz asks no more than one of 60 Hz. */
export const WISH = 0.012;
/** Readings in a wish at most, as the service takes them. */
export const MOST_READINGS = 40;
/** Of the pad's smaller side: where the finger asks for full speed, and up to where for nothing. */
export const PAD_FULL = 0.4;
export const PAD_DEAD = 0.1;

/** Drive keys by KeyboardEvent.code: share forward, share left. */
export const DRIVE_KEYS = new Map([
  ["ArrowUp", [1, 0]],
  ["ArrowDown", [-1, 0]],
  ["ArrowLeft", [0, 1]],
  ["ArrowRight", [0, -1]],
  ["KeyW", [1, 0]],
  ["KeyS", [-1, 0]],
  ["KeyA", [0, 1]],
  ["KeyD", [0, -1]],
]);

/** @typedef {"tilt" | "pad" | "keys" | "gamepad"} Input */
/** @typedef {[string, string] | null} Tick */
/** @typedef {"finger" | "cancelled" | "hidden" | "focus" | "turned" | "idle" | "stalled" | "left" | "gamepad"} Why */

/** Whether an event of this time is handled early enough to count. */
export function isFresh(when, now) {
  return Math.abs(now - when) <= EVENT_FRESH;
}

/** One axis of the pad: `moved` pixels on a pad whose smaller side is `side`, as a share of full speed. */
export function padShare(moved, side) {
  if (!(side > 0)) return 0;
  const dead = PAD_DEAD * side;
  const beyond = Math.max(0, Math.abs(moved) - dead) / (PAD_FULL * side - dead);
  return beyond === 0 ? 0 : Math.sign(moved) * Math.min(1, beyond);
}

/** Holds, and says what is to be said. Whatever ends a hold ends it for good: the next one is a new touch. */
export class Hand {
  /** @param {(message: object) => void} say takes each wish and each let_go as soon as it is made */
  constructor(say) {
    this._say = say;
    /** @type {Input} */
    this.input = "pad";
    /** Number of the hold in force; 0: none. */
    this.hold = 0;
    /** Why the last hold ended, or a late touch began none; empty: neither, or a hold is in force. */
    this.ended = "";
    this.angle = 0;
    this._holds = 0;
    this._n = 0;
    this._mayDrive = false;
    this._visible = true;
    this._focused = true;
    this._stopped = false;
    /** @type {Tick} */
    this._tick = null;
    this._drives = false;
    this._stateAt = -Infinity;
    /** Pointers that lie on the pad, with their kind; the one that holds. */
    this._lying = new Map();
    this._pointer = null;
    /** What the stick of the gamepad that holds asks: forward, left; null: no gamepad holds. */
    this._stick = null;
    /** Drive keys that are down and count, and those that must be lifted first. */
    this._down = new Set();
    this._spent = new Set();
    this._neutral = true;
    this._eventAt = -Infinity;
    this._frameAt = -Infinity;
    this._lookAt = -Infinity;
    this._wishAt = -Infinity;
    /** @type {Tick} */
    this._wishTick = null;
    this._readings = [];
    /** @type {Tick} */
    this._readingTick = null;
  }

  // What the page is told and how it stands.

  /** Take a state as it arrives. `stopped`: it shows the emergency stop engaged; `drives`: this page's hand drives. */
  onState(tick, stopped, drives, now) {
    this._tick = tick;
    this._drives = drives;
    this._stateAt = now;
    if (stopped && !this._stopped) {
      this._end("finger"); // whoever releases it moves no hand that lay there before
      this.ended = ""; // what ended a hold before the stop says nothing of the robot after it
    }
    this._stopped = stopped;
  }

  /** Newest tick of the robot. */
  get tick() {
    return this._tick;
  }

  /** A state has come within LINK_LOST. */
  isLinked(now) {
    return now - this._stateAt <= LINK_LOST;
  }

  /** The connection was cut: both sides end the hold by silence. */
  onCut() {
    this._stateAt = -Infinity;
    this._tick = null;
    this._silence("lost");
  }

  onMayDrive(may) {
    if (!may) this._silence("refused");
    this._mayDrive = may;
  }

  /** The service does not count this hold. */
  onRefused() {
    this._silence("refused");
  }

  /** The emergency stop was asked for here. */
  onStop() {
    this._end("finger");
  }

  choose(input) {
    if (input === this.input) return;
    this._end("finger");
    this.ended = "";
    this.input = input;
    this._readings = [];
  }

  onVisible(visible) {
    this._visible = visible;
    if (!visible) this._end("hidden");
  }

  onFocused(focused) {
    this._focused = focused;
    if (!focused) this._end("focus");
  }

  onLeft() {
    this._end("left");
  }

  /** The screen's content is turned by another angle, degrees. */
  onAngle(angle) {
    const turned = (((Math.round(angle / 90) * 90) % 360) + 360) % 360;
    if (turned !== this.angle) this._end("turned");
    this.angle = turned;
  }

  /** The screen says that it was turned, by whatever angle. */
  onTurned() {
    this._end("turned");
  }

  // Fingers.

  /**
   * A pointer was put on the pad.
   * @param {{id: number, kind: string, primary: boolean, button: number, x: number, y: number, side: number,
   *   when: number}} touch `side`: the pad's smaller one, pixels; `primary`: no other of its kind is down anywhere
   * @returns {boolean} it holds: capture it
   */
  onPointerDown(touch, now) {
    if (touch.primary) for (const [id, kind] of this._lying) if (kind === touch.kind) this._lying.delete(id);
    const alone = this._lying.size === 0;
    this._lying.set(touch.id, touch.kind);
    if (["keys", "gamepad"].includes(this.input) || !alone || touch.button !== 0) return false;
    if (!this._counts(touch.when, now) || !this._begin(now)) return false;
    const { id, x, y, side } = touch;
    this._pointer = { id, x0: x, y0: y, x, y, side };
    return true;
  }

  onPointerMove(id, x, y, when, now) {
    if (this._pointer?.id !== id || !isFresh(when, now)) return;
    this._pointer.x = x;
    this._pointer.y = y;
    this._eventAt = now;
  }

  onPointerUp(id) {
    this._lying.delete(id);
    if (this._pointer?.id === id) this._end("finger");
  }

  /** The browser took the pointer, or it is no longer captured. `lying`: the finger may still be there. */
  onPointerLost(id, lying) {
    if (!lying) this._lying.delete(id);
    if (this._pointer?.id === id) this._end("cancelled");
  }

  // Keys.

  /** @returns {boolean} it is a drive key's, and the page's own answer to it is not wanted */
  onKeyDown(code, repeat, when, now) {
    if (this.input !== "keys" || !DRIVE_KEYS.has(code)) return false;
    if (this._down.has(code)) {
      if (isFresh(when, now)) this._eventAt = now;
      return true;
    }
    if (repeat || this._spent.has(code) || !this._counts(when, now)) {
      this._spent.add(code);
      return true;
    }
    if (this.hold || this._begin(now)) {
      this._down.add(code);
      this._eventAt = now;
    } else {
      this._spent.add(code);
    }
    return true;
  }

  onKeyUp(code, now) {
    this._spent.delete(code);
    if (!this._down.delete(code)) return;
    this._eventAt = now;
    if (this._down.size === 0) this._end("finger");
  }

  // A gamepad.

  /** Take the press of a gamepad's switch. Only a centred stick may begin. @returns {boolean} it holds */
  onSwitchDown(centred, when, now) {
    if (this.input !== "gamepad" || this.hold || !this._counts(when, now)) return false;
    if (!centred) this.ended = "centre";
    if (!centred || !this._begin(now)) return false;
    this._stick = [0, 0];
    return true;
  }

  /** Take the stick of the gamepad that holds. `moved`: some stick or button has moved since the last frame. */
  onStick(asks, moved, now) {
    if (!this._stick) return;
    this._stick = asks;
    // A gamepad out of reach keeps its last state, and looks like a still one: that may ask for nothing for long.
    if (moved || asks.every((share) => share === 0)) this._eventAt = now;
  }

  onSwitchUp() {
    if (this._stick) this._end("finger");
  }

  /** The gamepad that held is not there any more, or says nothing that can be used. */
  onGamepadGone() {
    if (this._stick) this._end("gamepad");
  }

  // The phone's motion.

  /** A reading of the phone's acceleration, m/s². @returns {boolean} it counts */
  onMotion(x, y, z, when, now) {
    if (!isFresh(when, now) || ![x, y, z].every(Number.isFinite)) return false;
    if (this.input !== "gamepad") this._eventAt = now; // the phone may lie beside the gamepad
    if (this.input !== "tilt") return true;
    this._readings.push([when, x, y, z]);
    if (this._readings.length > MOST_READINGS) this._readings.shift();
    this._readingTick = this._tick;
    return true;
  }

  // Time.

  /** An animation frame: the only moment at which a wish is sent. */
  onFrame(now) {
    const gap = now - this._frameAt;
    this._frameAt = now;
    if (this.hold && gap > STALLED) this._end("stalled");
    this._check(now);
    if (!this._mayWish(now)) {
      this._readings = [];
      return;
    }
    if (now - this._wishAt < WISH) return;
    if (this.hold) this._wish(now);
    else if (this.input === "tilt") {
      if (this._readings.length) this._wish(now);
    } else if (this._holds && this._isIdleDue(now)) this._wish(now);
  }

  /** A look of the timer: it ends what no animation frame ends. */
  onLook(now) {
    const gap = now - this._lookAt;
    this._lookAt = now;
    if (this.hold && (gap > STALLED || now - this._frameAt > STALLED)) this._end("stalled");
    this._check(now);
  }

  /** What the hand asks now, as shares of full speed: forward, left. Of `tilt` the service knows. */
  get asks() {
    if (!this.hold || this.input === "tilt") return [0, 0];
    if (this._stick) return this._stick;
    if (this._pointer) {
      const { x0, y0, x, y, side } = this._pointer;
      return [padShare(y0 - y, side), padShare(x0 - x, side)];
    }
    let [forward, left] = [0, 0];
    for (const code of this._down) {
      const [f, l] = DRIVE_KEYS.get(code);
      forward += f;
      left += l;
    }
    return [Math.max(-1, Math.min(1, forward)), Math.max(-1, Math.min(1, left))];
  }

  /** Where the finger that holds was put, and where it is; null: none holds. */
  get finger() {
    return this._pointer;
  }

  /** Drive keys that count now. */
  get pressed() {
    return this._down;
  }

  _mayWish(now) {
    return this._mayDrive && this._visible && this._focused && this.isLinked(now);
  }

  /**
   * A hand that drives says with each state's tick that it is neutral. Base arms by neutral moments that lie at most
   * 0.1 s apart; states come each 0.04 s.
   */
  _isIdleDue(now) {
    return this._drives ? this._tick !== this._wishTick : now - this._wishAt >= IDLE_WISH;
  }

  _check(now) {
    if (!this.hold) return;
    if (!this.isLinked(now)) this._silence("lost");
    else if (now - this._eventAt > IDLE) this._end("idle");
  }

  /** A touch or a key of this time may hold. Where it comes too late, the page says why it does nothing. */
  _counts(when, now) {
    if (isFresh(when, now)) return true;
    if (!this.hold) this.ended = "stalled";
    return false;
  }

  _begin(now) {
    if (this._stopped || !this._mayWish(now)) return false;
    this._holds += 1;
    this.hold = this._holds;
    this.ended = "";
    this._neutral = true;
    this._eventAt = this._frameAt = this._lookAt = now;
    return true;
  }

  _wish(now) {
    const tilt = this.input === "tilt";
    const [forward, left] = this._neutral ? [0, 0] : this.asks;
    const tick = tilt ? this._readingTick : this._tick;
    const wish = { type: "wish", n: this._n++, tick, hold: this.hold, input: this.input, forward, left };
    this._wishAt = now;
    this._wishTick = tick;
    this._neutral = false;
    this._say({ ...wish, readings: this._readings, angle: this.angle });
    this._readings = [];
  }

  /** @param {Why} why */
  _end(why) {
    if (!this.hold) return;
    this._silence(why);
    this._say({ type: "let_go", n: this._n++, why });
  }

  /** The hold ends without a word. */
  _silence(why) {
    if (!this.hold) return;
    this.hold = 0;
    this.ended = why;
    this._pointer = this._stick = null;
    for (const code of this._down) this._spent.add(code);
    this._down.clear();
  }
}
