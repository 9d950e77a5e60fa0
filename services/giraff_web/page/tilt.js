// The phone's motion sensor: its readings to the hand, as raw as the browser gives them.

/** ms after which a sensor that says nothing is not there. */
const PATIENCE = 1500;

const INSTEAD = "The pad is used instead.";

export class Motion {
  /**
   * @param {import("./hand.js").Hand} hand
   * @param {() => number} clock s
   */
  constructor(hand, clock) {
    this._clock = clock;
    this._heard = false;
    this._onMotion = (event) => {
      const pull = event.accelerationIncludingGravity;
      if (!pull || pull.x === null || pull.y === null || pull.z === null) return;
      if (hand.onMotion(pull.x, pull.y, pull.z, event.timeStamp / 1000, clock())) this._heard = true;
    };
    // A finger that rests says nothing, and the phone in the hand still does: readings count as life of any input.
    // Whether a browser wants to be asked first, only its answer tells: Chromium has requestPermission and needs none.
    this._listen();
  }

  /** Ask for the sensor, from a tap. @returns {Promise<string>} why there is none; empty: it is there */
  async open() {
    if (!isSecureContext) return `A browser reads the phone's motion at an https address only. ${INSTEAD}`;
    if (typeof DeviceMotionEvent === "undefined") return `This browser does not tell how the phone moves. ${INSTEAD}`;
    const asks = /** @type {any} */ (DeviceMotionEvent).requestPermission;
    if (asks) {
      const answer = await asks.call(DeviceMotionEvent).catch(() => "denied");
      if (answer !== "granted") return `The phone's motion was not allowed: reload the page and allow it. ${INSTEAD}`;
    }
    this._heard = false;
    this._listen();
    const until = this._clock() + PATIENCE / 1000;
    while (!this._heard && this._clock() < until) await new Promise((resolve) => setTimeout(resolve, 50));
    return this._heard ? "" : `No motion sensor is heard on this device. ${INSTEAD}`;
  }

  /** Anew: a listener that was there before the sensor was allowed may stay deaf. */
  _listen() {
    removeEventListener("devicemotion", this._onMotion);
    addEventListener("devicemotion", this._onMotion);
  }
}

/** By how much the screen's content is turned in the device, degrees. */
export function screenAngle() {
  return screen.orientation?.angle ?? /** @type {any} */ (window).orientation ?? 0;
}
