// The emergency stop as this page asked for it: not confirmed before a state says so. No DOM and no clock.

/** s after which an unconfirmed stop asks for the battery switch. */
export const PATIENCE = 1.0;
/** s between two requests, and for how long they go on. */
export const AGAIN = 0.5;
export const LONGEST = 60.0;
/** s for which STOP is held to ask for off, too. */
export const HELD = 2.0;
/** s between two looks. A page that stood still for longer does not know what was held meanwhile. */
const STALLED = 0.5;

export class StopRequest {
  constructor() {
    this._pressedAt = NaN;
    this._saidAt = NaN;
    this._heldSince = NaN;
    this._lookedAt = NaN;
    this._offSaidAt = NaN;
    /** @type {any} the newest latch that was shown */
    this.latch = null;
  }

  /** STOP was pressed: say so now. */
  press(now) {
    if (!this.isOpen || now - this._pressedAt > LONGEST) this._pressedAt = now;
    this._saidAt = now;
  }

  /** STOP is held from now on. */
  hold(now) {
    this._heldSince = this._lookedAt = now;
    this._offSaidAt = NaN;
  }

  letGo() {
    this._heldSince = NaN;
  }

  /** Whether to ask for off now: STOP has been held for so long, and base does not say that it is off. */
  isOffDue(now) {
    if (now - this._lookedAt > STALLED) this._heldSince += now - this._lookedAt;
    this._lookedAt = now;
    if (!(now - this._heldSince >= HELD) || this.latch?.off || now - this._offSaidAt < AGAIN) return false;
    this._offSaidAt = now;
    return true;
  }

  /** A stop was asked for here that no state has confirmed. */
  get isOpen() {
    return !Number.isNaN(this._pressedAt);
  }

  /** Take what a state says of the latch; null: base is not heard. */
  onLatch(latch) {
    this.latch = latch;
    if (latch?.engaged) this._pressedAt = NaN;
  }

  /** Whether to ask again now. */
  isDue(now) {
    if (!this.isOpen || now - this._pressedAt > LONGEST || now - this._saidAt < AGAIN) return false;
    this._saidAt = now;
    return true;
  }

  /** What is written at the button; `linked`: states are coming in. */
  text(now, linked) {
    if (this.isOpen) {
      const late = now - this._pressedAt >= PATIENCE;
      return late ? "NOT CONFIRMED: use the battery switch" : "STOPPING, NOT CONFIRMED";
    }
    if (!this.latch?.engaged) return "";
    const who = `by ${this.latch.by}: ${this.latch.reason.what}`;
    const what = this.latch.off ? "OFF" : "STOPPED";
    if (!linked) return `When last heard: ${what} ${who}`;
    return !this.latch.off && now - this._offSaidAt < PATIENCE ? "STOPPED; off is asked for" : `${what}, ${this.latch.word}, ${who}`;
  }
}

/** Whether two latches are one and the same stop. */
export function isSameStop(one, other) {
  return Boolean(one?.engaged && other?.engaged && one.id === other.id && one.engaged_ns === other.engaged_ns);
}
