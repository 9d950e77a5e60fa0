// The picture of the robot's camera: who looks, whether this page does, and how old what it shows is.

import { byId, write } from "./panel.js";
import { OLD, line, sentence } from "./words.js";

/** Bytes before the JPEG: number of the picture, then epoch and ns of its tick, big end first. */
const HEADER = 16;
/** By how much the clocks of robot and page may drift apart, s each s. */
const DRIFT = 0.001;
const TAP = "tap to see it again";

/** The robot's clock, by the ticks of the states: a state that was late on its way never sets it back. */
export class RobotClock {
  constructor() {
    this._epoch = 0;
    this._ahead = 0;
    this._at = 0;
  }

  /** @param {[string, string]} tick  @param {number} now s */
  onTick([epoch, ns], now) {
    const ahead = Number(ns) / 1e9 - now;
    const kept = this._ahead - DRIFT * (now - this._at);
    this._ahead = Number(epoch) === this._epoch ? Math.max(kept, ahead) : ahead;
    this._epoch = Number(epoch);
    this._at = now;
  }

  /** s since the robot's clock showed this; null: nobody knows. */
  age(epoch, ns, now) {
    if (!epoch || epoch !== this._epoch) return null;
    return Math.max(0, now + this._ahead - ns / 1e9);
  }
}

/** What a binary message holds. @param {ArrayBuffer} buffer */
export function unpacked(buffer) {
  const view = new DataView(buffer);
  const jpeg = new Blob([new Uint8Array(buffer, HEADER)], { type: "image/jpeg" });
  return { n: view.getUint32(0), epoch: view.getUint32(4), ns: Number(view.getBigUint64(8)), jpeg };
}

export function ageText(age) {
  return age === null ? "of unknown age" : `${age.toFixed(1)} s old`;
}

/** Whether somebody sees the robot's surroundings, for every page. @param {any} camera as the state has it */
export function cameraText(camera, mayDrive) {
  const why = line(camera.why, mayDrive);
  const on = camera.askers.length ? `The robot’s camera is on, for ${camera.askers.join(", ")}. ` : "";
  return on + (why ? `${sentence(why)}.` : on ? "" : "The robot’s camera is off.");
}

export class Picture {
  /** @param {(message: object) => void} say */
  constructor(say) {
    this._say = say;
    this._clock = new RobotClock();
    this._on = false;
    /** Why it is off though a person wants it; empty: it is on, or nobody wants it. */
    this._why = "";
    /** The newest that is shown. */
    this._shown = /** @type {any} */ (null);
    this._drawnOld = false;
    this._whole = false;
    this._pen = byId("picture").getContext("2d");
    byId("look").addEventListener("click", () => this._tap());
    document.addEventListener("click", ({ target }) => this._click(/** @type {Element} */ (target)));
    document.addEventListener("keydown", ({ key, target }) => {
      if (key === "Enter" && target === byId("picture")) this._fill(!this._whole);
      if (key === "Escape" && !(/** @type {Element} */ (target).closest("dialog"))) this._fill(false);
    });
    addEventListener("popstate", () => this._fill(false));
  }

  onHello() {
    this._clock = new RobotClock();
  }

  onState(state, now) {
    if (state.tick) this._clock.onTick(state.tick, now);
  }

  onLooking({ on, why }) {
    this._on = on;
    if (on || why.what) this._why = line(why, true); // only a page that may drive looks
  }

  /** What has ended it here, where it was on; only a person brings it back. */
  end(why) {
    if (!this._on) return;
    this._on = false;
    this._why = `${why}; ${TAP}`;
    this._say({ type: "look", on: false });
  }

  /** @param {ArrayBuffer} buffer */
  async onPicture(buffer) {
    if (!this._on) return;
    const { n, epoch, ns, jpeg } = unpacked(buffer);
    const image = await createImageBitmap(jpeg).catch(() => null); // a torn one shows nothing, and ages
    if (image && this._on) {
      const canvas = byId("picture");
      if (canvas.width !== image.width) canvas.width = image.width;
      if (canvas.height !== image.height) canvas.height = image.height;
      this._pen.drawImage(image, 0, 0);
      this._shown = { epoch, ns };
    }
    image?.close();
    this._say({ type: "picture_seen", n });
  }

  /** Whether what is shown has become too old since it was drawn, or new again: that waits for no look of the timer. */
  hasAged(now) {
    return Boolean(this._shown) && this._isOld(this._age(now)) !== this._drawnOld;
  }

  draw(at, now) {
    const camera = at.state?.camera;
    if (!camera || !this._on) this._fill(false); // what has ended is told on the page
    byId("camera").hidden = !camera;
    if (!camera) return;
    const age = this._age(now);
    this._drawnOld = this._isOld(age);
    byId("shown").hidden = !this._shown;
    document.body.dataset.picture = this._shown ? "shown" : "";
    byId("shown").classList.toggle("old", this._drawnOld);
    write(byId("picture-age"), ageText(age));
    const own = this._why ? `Your picture is off: ${this._why}. ` : "";
    write(byId("camera-text"), at.linked ? own + cameraText(camera, at.mayDrive) : own);
    const button = byId("look");
    button.hidden = !at.mayDrive;
    write(button, this._on ? "Hide" : "Show picture");
    button.setAttribute("aria-label", this._on ? "Hide the camera’s picture" : "Show picture of the camera");
  }

  _age(now) {
    return this._shown && this._clock.age(this._shown.epoch, this._shown.ns, now);
  }

  _isOld(age) {
    return age === null || age >= OLD;
  }

  /** A tap on the picture makes it fill the screen, and one beside what is touched there ends that. */
  _click(target) {
    if (!this._whole) this._fill(target === byId("picture"));
    else if (!target.closest("#status, #drive, #emergency, #look")) this._fill(false);
  }

  /** Fill the screen, or end that. The browser's own way back ends it, too. */
  _fill(whole) {
    if (whole === this._whole || (whole && !(this._on && this._shown))) return;
    this._whole = whole;
    document.body.classList.toggle("whole", whole);
    byId("picture").setAttribute("aria-pressed", String(whole));
    // Only a person goes back: at the same time as them the page would go one step too far, and leave.
    if (whole && history.state !== "whole") history.pushState("whole", "");
  }

  _tap() {
    this._say({ type: "look", on: !this._on });
    this._why = "";
    if (this._on) this._shown = null;
    this._on = false; // until the service says so
  }
}
