// The other pages that are open, for a page that may drive: it may end them.

import { byId, write } from "./panel.js";

/** What a page is there for. `driver`: number of the page that drives; 0: none. */
export function doesText(row, driver) {
  if (row.page === driver) return "drives";
  return row.may_drive ? "may drive" : "watches";
}

/** A row of the list. `since`: when the page was opened, as people read it. */
export function rowText(row, driver, since) {
  return `${row.device}, since ${since}: ${doesText(row, driver)}`;
}

export function countText(count) {
  return count === 1 ? "1 other page" : `${count} other pages`;
}

export class Others {
  /** @param {(page: number) => void} end ends the page of that number */
  constructor(end) {
    this._end = end;
    this._rows = [];
  }

  /** @param {any[]} pages all that are open  @param {number} me this one's number */
  onPages(pages, me) {
    const now = Date.now();
    this._rows = pages.filter((row) => row.page !== me);
    for (const row of this._rows) {
      const opened = new Date(now - row.age * 1000);
      row.since = opened.toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
    }
    write(byId("pages-count"), countText(this._rows.length));
    byId("pages-list").replaceChildren(...this._rows.map((row) => this._item(row)));
  }

  draw(at) {
    byId("pages").hidden = !(at.linked && at.mayDrive && this._rows.length);
    this._rows.forEach((row, index) => {
      const text = rowText(row, at.state?.page ?? 0, row.since);
      write(byId("pages-list").children[index].firstElementChild, text);
    });
  }

  _item(row) {
    const item = document.createElement("li");
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "End";
    button.setAttribute("aria-label", `End the page of ${row.device}`);
    button.addEventListener("click", () => this._end(row.page));
    item.append(document.createElement("span"), button);
    return item;
  }
}
