// A route to a place of the floor plan: asked for with two taps, and held as long as this page is in front.

import { byId, write } from "./panel.js";
import { goalText, goesOn, isStopped, knownPlan, routeText } from "./words.js";

/** px around a place's dot within which a finger means it. */
export const FINGER = 24;

/**
 * What a tap on the plan means: the name of a place, or a point in metres.
 * @param {{a: number, b: number, c: number, d: number, e: number, f: number}} matrix from the plan to pixels
 * @param {number} finger pixels
 * @returns {string | [number, number]}
 */
export function goalAt({ a, b, c, d, e, f }, places, x, y, finger) {
  const away = (place) => Math.hypot(a * place.x + c * place.y + e - x, b * place.x + d * place.y + f - y);
  const [nearest] = [...places].sort((one, other) => away(one) - away(other));
  if (nearest && away(nearest) <= finger) return nearest.name;
  const [east, north, turned] = [x - e, y - f, a * d - b * c];
  const metres = [(d * east - c * north) / turned, (a * north - b * east) / turned];
  return /** @type {[number, number]} */ (metres.map((value) => Math.round(value * 100) / 100));
}

/** This page's routes. No DOM and no clock. */
export class RouteHand {
  /** @param {(message: object) => void} say */
  constructor(say) {
    this._say = say;
    /** The goal that the page asks about; null: none. @type {string | [number, number] | null} */
    this.asked = null;
    /** Where this page's route goes; null: it has none. @type {string | [number, number] | null} */
    this.goal = null;
    this._n = 0;
    /** @type {[string, string] | null} */
    this._held = null;
  }

  /** A tap on the plan. */
  onTap(goal) {
    if (this.goal === null) this.asked = goal;
  }

  /** The second tap. `tick`: the newest of the robot. */
  go(tick) {
    [this.goal, this.asked] = [tick && this.asked, null];
    if (this.goal === null) return;
    this._n += 1;
    this._held = tick;
    this._say({ type: "go", n: this._n, tick, goal: this.goal });
  }

  /** An animation frame: the only moment at which a hold is said, once for each state. */
  onFrame(tick) {
    if (this.goal === null || !tick || tick === this._held) return;
    this._held = tick;
    this._say({ type: "route_hold", tick });
  }

  /** Let go: the page is not in front, or a hand drives. */
  end() {
    const had = this.goal !== null;
    this.asked = this.goal = null;
    if (had) this._say({ type: "route_cancel", n: this._n });
  }

  /** Stop was pressed: it ends whichever route goes on. */
  stop() {
    this.asked = this.goal = null;
    this._say({ type: "route_cancel" });
  }

  onRoute(route, me) {
    if (route.page === me && route.n === this._n && route.stage === "ended") this.goal = null;
  }

  /** The service has no route of this page. @returns {boolean} the page thought so */
  onOver() {
    const had = this.goal !== null;
    this.goal = null;
    return had;
  }

  onCut() {
    this.asked = this.goal = null;
  }
}

/** The bar that asks, and shows where the robot goes, with one button that ends it. */
export class RouteBar {
  /**
   * @param {RouteHand} hand
   * @param {{go: (when: number) => void}} way `when`: of the tap, s
   */
  constructor(hand, way) {
    this._hand = hand;
    byId("route-yes").addEventListener("click", (event) => way.go(event.timeStamp / 1000));
    byId("route-no").addEventListener("click", () => (hand.asked = null));
    byId("route-stop").addEventListener("click", () => hand.stop());
    const leaves = (key) => key === "Escape" && !document.querySelector("body.whole, dialog[open]"); // it ends those
    addEventListener("keydown", ({ key }) => leaves(key) && hand.end(), { capture: true });
  }

  /** Whether a tap on the plan may ask for a route. */
  static mayAsk(at) {
    const known = at.linked && at.mayDrive && !at.hold && !isStopped(at.state) && knownPlan(at.state, at.plan);
    return Boolean(known && known.walls.length && document.hasFocus());
  }

  draw(at) {
    const hand = this._hand;
    if (!RouteBar.mayAsk(at)) hand.asked = null;
    const [asks, goes] = [hand.asked !== null, at.linked && (hand.goal !== null || goesOn(at.route))];
    byId("route").hidden = !(asks || goes);
    document.body.dataset.route = asks || goes ? "shown" : "";
    byId("route-text").setAttribute("aria-live", asks ? "polite" : "off"); // metres are read, and not spoken
    write(byId("route-text"), asks ? `Go to ${goalText(hand.asked)}?` : goes ? routeText(at.route, hand.goal) : "");
    for (const id of ["route-no", "route-yes"]) byId(id).hidden = !asks;
    byId("route-stop").hidden = !goes;
  }
}
