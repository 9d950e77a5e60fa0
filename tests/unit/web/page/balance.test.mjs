// The plots of a robot that balances.

import assert from "node:assert/strict";
import { test } from "node:test";

import { reachOf } from "../../../../services/giraff_web/page/balance.js";

test("a plot reaches as far as its values, in steps", () => {
  assert.deepEqual([[], [0.4, -5], [5.1]].map((values) => reachOf(values, 5)), [5, 5, 10]);
});
