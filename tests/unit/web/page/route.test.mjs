// A route: what a tap means, what the page says meanwhile, and what is written of it.

import assert from "node:assert/strict";
import { test } from "node:test";

import { FINGER, RouteHand, goalAt } from "../../../../services/giraff_web/page/route.js";
import { goalText, routeText, routeWhy, whyText } from "../../../../services/giraff_web/page/words.js";
import { TICK } from "./pages.mjs";

const well = { what: "", remedy: "", action: "", argument: "" };
const moving = { stage: "moving", page: 3, n: 1, by: "web@desk (phone)", goal: "kitchen", leg: 2, legs: 5, come: 3.2, way: 7.9, outcome: "", why: well };

const asked = () => {
  const said = [];
  const hand = new RouteHand((message) => said.push(message));
  hand.onTap("kitchen");
  hand.go(TICK(1));
  return { hand, said };
};

test("a tap means the place within a finger of it, else the point", () => {
  const up = { a: 0, b: -50, c: -50, d: 0, e: 200, f: 300 }; // x is up, y is left
  const places = [{ name: "far", x: 2, y: -2 }, { name: "kitchen", x: 2, y: 1 }];
  assert.equal(goalAt(up, places, 150 + FINGER, 200, FINGER), "kitchen");
  assert.deepEqual(goalAt(up, places, 151 + FINGER, 200, FINGER), [2, 0.5]);
  assert.deepEqual(goalAt(up, [], 150, 260, FINGER), [0.8, 1]);
});

test("nothing is said before the second tap, which has the tick of then", () => {
  const said = [];
  const hand = new RouteHand((message) => said.push(message));
  hand.onTap([3.2, 1.5]);
  hand.onFrame(TICK(1));
  assert.deepEqual([said, hand.asked], [[], [3.2, 1.5]]);
  hand.go(TICK(2));
  assert.deepEqual(said, [{ type: "go", n: 1, tick: TICK(2), goal: [3.2, 1.5] }]);
  const lost = new RouteHand((message) => said.push(message));
  lost.onTap("kitchen");
  lost.go(null);
  assert.deepEqual([lost.goal, said.length], [null, 1]);
});

test("it is held once for each state, until it ends", () => {
  const { hand, said } = asked();
  const tick = TICK(2);
  for (const newest of [tick, tick, null, TICK(3)]) hand.onFrame(newest);
  hand.onTap("desk");
  assert.equal(hand.asked, null, "Stop stays in its place");
  assert.deepEqual(said.slice(1), [2, 3].map((n) => ({ type: "route_hold", tick: TICK(n) })));
  hand.onRoute(moving, 3);
  for (const other of [{ ...moving, page: 4 }, { ...moving, n: 9 }]) hand.onRoute({ ...other, stage: "ended" }, 3);
  assert.equal(hand.goal, "kitchen");
  hand.onRoute({ ...moving, stage: "ended" }, 3);
  hand.onFrame(TICK(4));
  assert.deepEqual([hand.goal, said.length], [null, 3]);
});

test("a page that is hidden ends its own, Stop ends any, and neither is held on to", () => {
  const ends = { end: [{ type: "route_cancel", n: 1 }], stop: [{ type: "route_cancel" }], onCut: [], onOver: [] };
  for (const [end, says] of Object.entries(ends)) {
    const { hand, said } = asked();
    hand[end]();
    hand.onFrame(TICK(2));
    assert.deepEqual(said.slice(1), says);
    hand.end();
    assert.equal(said.length, 1 + says.length);
  }
});

test("where to, how far, why it waits, and how it has ended", () => {
  assert.deepEqual(["kitchen", [3.2, -0.04]].map(goalText), ["kitchen", "(3.2, 0.0)"]);
  assert.equal(routeText(moving, "kitchen"), "To kitchen: leg 2 of 5, 3.2 of 7.9 m");
  assert.equal(routeText(null, [3.21, 1.5]), "To (3.2, 1.5): asked for");
  const why = (change) => routeWhy({ ...moving, ...change }, true);
  assert.equal(why({}), "Going to kitchen for web@desk (phone).");
  const blocked = { ...well, what: "front sees something", remedy: "clear the way" };
  assert.equal(why({ stage: "waiting", why: blocked }), "Front sees something; clear the way.");
  assert.equal(why({ stage: "ended", outcome: "arrived" }), "Arrived at kitchen.");
  assert.equal(why({ stage: "ended", outcome: "no_way", why: blocked }), "Not at kitchen: front sees something; clear the way.");
  assert.equal(why({ stage: "ended", outcome: "lost_requester" }), "Not at kitchen: lost requester.");
  const at = { linked: true, mayDrive: true, state: { why: blocked, stop: null }, route: moving };
  assert.equal(whyText(at), "Going to kitchen for web@desk (phone).");
  assert.equal(whyText({ ...at, refused: "phone drives" }), "Phone drives");
  assert.match(whyText({ ...at, mayDrive: false }), /^Going to kitchen .* open the address/);
  assert.equal(whyText({ ...at, hold: 2 }), "Front sees something; clear the way");
});
