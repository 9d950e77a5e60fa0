// The emergency stop as the page asks for it and says it.

import assert from "node:assert/strict";
import { test } from "node:test";

import { AGAIN, HELD, LONGEST, StopRequest, isSameStop } from "../../../../services/giraff_web/page/stop.js";

const latch = (engaged = true, id = "1", engaged_ns = "5") => ({
  engaged,
  word: "confirmed",
  by: "ann",
  reason: { what: "a chair" },
  id,
  engaged_ns,
});

test("nothing is confirmed before a state says so", () => {
  const stop = new StopRequest();
  stop.onLatch(latch(false));
  assert.equal(stop.text(0, true), "");
  stop.press(10);
  assert.equal(stop.text(10, true), "STOPPING, NOT CONFIRMED");
  stop.onLatch(latch(false));
  stop.onLatch(null);
  assert.equal(stop.text(10.99, true), "STOPPING, NOT CONFIRMED");
  assert.equal(stop.text(11, true), "NOT CONFIRMED: use the battery switch");
  stop.onLatch(latch());
  assert.equal(stop.text(11.1, true), "STOPPED, confirmed, by ann: a chair");
  stop.onLatch({ ...latch(), word: "by the word of whoever answers" });
  assert.equal(stop.text(11.2, true), "STOPPED, by the word of whoever answers, by ann: a chair");
});

test("a second press does not hide that the first was not confirmed", () => {
  const stop = new StopRequest();
  stop.press(10);
  stop.press(11.5);
  assert.equal(stop.text(11.5, true), "NOT CONFIRMED: use the battery switch");
});

test("it asks again until it is confirmed, and not for ever", () => {
  const stop = new StopRequest();
  assert.equal(stop.isDue(9), false);
  stop.press(10);
  assert.equal(stop.isDue(10 + AGAIN - 0.01), false);
  assert.equal(stop.isDue(10 + AGAIN), true);
  assert.equal(stop.isDue(10 + AGAIN + 0.1), false);
  assert.equal(stop.isDue(10 + LONGEST + 1), false);
  assert.equal(stop.text(10 + LONGEST + 1, true), "NOT CONFIRMED: use the battery switch");
  stop.press(12);
  stop.onLatch(latch());
  assert.equal(stop.isDue(13), false);
});

test("a press after a long silence asks for as long again", () => {
  const stop = new StopRequest();
  stop.press(10);
  stop.press(10 + LONGEST + 5);
  assert.equal(stop.isDue(10 + LONGEST + 5 + AGAIN), true);
});

test("held, it asks for off until base says so, and no sooner nor longer", () => {
  const stop = new StopRequest();
  const asked = (from, to) => {
    let count = 0;
    for (let ms = from * 1000; ms < to * 1000; ms += 100) count += stop.isOffDue(ms / 1000);
    return count;
  };
  assert.equal(asked(0, 9), 0, "it is not held");
  stop.press(10);
  stop.hold(10);
  stop.onLatch(latch());
  assert.equal(asked(10, 10 + HELD), 0);
  assert.equal(asked(10 + HELD, 11 + HELD), 1 / AGAIN);
  assert.equal(stop.text(11 + HELD, true), "STOPPED; off is asked for");
  stop.onLatch({ ...latch(), off: true });
  assert.equal(stop.text(11 + HELD, true), "OFF, confirmed, by ann: a chair");
  assert.equal(asked(11 + HELD, 20), 0);
  stop.onLatch(latch());
  for (let press = 20; press < 30; press += 1.5) {
    stop.hold(press);
    assert.equal(asked(press, press + 1), 0);
    stop.letGo();
    assert.equal(asked(press + 1, press + 1.5), 0, "presses do not add up");
  }
  stop.hold(30);
  asked(30, 30.5);
  assert.equal(stop.isOffDue(60), false, "the page stood still");
});

test("what was heard before the link was lost is not said of now", () => {
  const stop = new StopRequest();
  stop.onLatch(latch());
  assert.equal(stop.text(20, false), "When last heard: STOPPED by ann: a chair");
});

test("one stop is another one than that which engaged later", () => {
  assert.equal(isSameStop(latch(), latch()), true);
  assert.equal(isSameStop(latch(), latch(true, "2")), false);
  assert.equal(isSameStop(latch(), latch(true, "1", "6")), false);
  assert.equal(isSameStop(latch(), latch(false)), false);
  assert.equal(isSameStop(latch(), null), false);
});
