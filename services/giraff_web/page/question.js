// The STOP button, and the question that releases a stop.

import { byId, write } from "./panel.js";
import { StopRequest, isSameStop } from "./stop.js";
import { line } from "./words.js";

/** s after a finger's landing within which a click is its lifting. */
const LIFTED = 2;

export class StopButton {
  /**
   * @param {() => number} clock s
   * @param {{say: (off: boolean) => void}} way asks the service, by every way there is
   */
  constructor(clock, way) {
    this._clock = clock;
    this._way = way;
    this._request = new StopRequest();
    this._detail = "";
    this._note = "";
    this._noteUntil = -Infinity;
    this._landedAt = -Infinity;
    const button = byId("stop");
    // The finger's landing, not its lifting: a click would come later, or not at all.
    button.addEventListener("pointerdown", () => {
      this._landedAt = clock();
      this.press();
      this.hold();
    });
    for (const end of ["pointerup", "pointercancel", "pointerleave"]) button.addEventListener(end, () => this.letGo());
    button.addEventListener("click", (event) => {
      // ENTER, or a screen reader; else it is the lifting of that finger.
      if (event.detail === 0 || clock() - this._landedAt > LIFTED) this.press();
    });
    button.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** A stop was asked for here that no state has confirmed. */
  get isOpen() {
    return this._request.isOpen;
  }

  press() {
    const now = this._clock();
    this._request.press(now);
    this._way.say(false);
    this.draw(now, true);
  }

  /** STOP stays pressed from now on, until it is let go: held for HELD s, it asks for off, too. */
  hold() {
    this._request.hold(this._clock());
  }

  letGo() {
    this._request.letGo();
  }

  onState(state, mayDrive) {
    this._request.onLatch(state.stop);
    this._detail = line(state.stop_outcome, mayDrive);
  }

  /** Show a line below the stop for so many seconds. */
  note(text, seconds) {
    this._note = text;
    this._noteUntil = this._clock() + seconds;
  }

  look(now) {
    if (this._request.isDue(now)) this._way.say(false);
    if (this._request.isOffDue(now)) this._way.say(true);
  }

  draw(now, linked) {
    const text = this._request.text(now, linked);
    write(byId("stop-text"), text);
    write(byId("stop-detail"), now < this._noteUntil ? this._note : linked ? this._detail : "");
    document.body.dataset.stop = this._request.isOpen ? "asked" : text ? "engaged" : "";
  }
}

export class Question {
  /** @param {{release: (latch: any, when: number) => void}} way `when`: of the tap, s */
  constructor(way) {
    /** @type {any} the stop that is asked about */
    this._asked = null;
    /** @type {any} the stop that is shown */
    this._shown = null;
    this._dialog = byId("question");
    byId("release").addEventListener("click", () => this._open());
    byId("release-no").addEventListener("click", () => this._close());
    byId("release-yes").addEventListener("click", (event) => {
      const latch = this._asked;
      this._close();
      if (isSameStop(latch, this._shown)) way.release(latch, event.timeStamp / 1000);
    });
    this._dialog.addEventListener("keydown", (event) => event.key === "Escape" && this._close());
  }

  draw(latch, mayDrive, linked) {
    const may = mayDrive && linked && Boolean(latch?.engaged);
    this._shown = latch;
    byId("release").hidden = !latch?.engaged || !mayDrive;
    byId("release").disabled = !may;
    byId("release-yes").disabled = !may;
    if (this._asked && !(latch === null || latch === undefined) && !isSameStop(latch, this._asked)) this._close();
  }

  /** Not as a modal one: STOP stays within reach. */
  _open() {
    this._asked = this._shown;
    if (!this._asked?.engaged) return;
    write(byId("question-by"), this._asked.by);
    write(byId("question-why"), this._asked.reason.what);
    if (!this._dialog.open) this._dialog.show();
    byId("release-no").focus();
  }

  _close() {
    this._asked = null;
    if (!this._dialog.open) return;
    this._dialog.close();
    const release = byId("release");
    (release.hidden ? byId("stop") : release).focus();
  }
}
