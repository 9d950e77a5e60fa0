// The list of the other open pages.

import assert from "node:assert/strict";
import { test } from "node:test";

import { countText, rowText } from "../../../../services/giraff_web/page/others.js";

test("a row says whose page it is, since when, and what it is there for", () => {
  const row = { page: 3, device: "iPhone at 10.0.0.7", may_drive: true };
  assert.equal(rowText(row, 3, "19:24"), "iPhone at 10.0.0.7, since 19:24: drives");
  assert.equal(rowText(row, 0, "19:24"), "iPhone at 10.0.0.7, since 19:24: may drive");
  assert.match(rowText({ ...row, may_drive: false }, 0, "19:24"), /: watches$/);
  assert.deepEqual([1, 2].map(countText), ["1 other page", "2 other pages"]);
});
