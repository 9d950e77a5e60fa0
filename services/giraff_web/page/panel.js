// What is written on the page, where it stands in the document.

import { DIRECTIONS, OLD, ageText, armedText, driverText, facts, floorLines, clearance, isStopped, placeText, reasons, whyText } from "./words.js";

/** s between two changes of a line that a screen reader speaks, and of the floor plan's text. */
const SPOKEN = 0.3;
const FLOOR_TEXT = 1.0;

/** @param {string} id @returns {any} */
export const byId = (id) => document.getElementById(id);

/** Write only what is another text, so that nothing is spoken twice. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Show a list of lines, replacing only what has changed. */
function writeList(list, lines) {
  while (list.children.length > lines.length) list.lastElementChild.remove();
  while (list.children.length < lines.length) list.append(document.createElement("li"));
  lines.forEach((line, index) => write(list.children[index], line));
}

export class Panel {
  constructor() {
    this._whyAt = -Infinity;
    this._floorAt = -Infinity;
  }

  /**
   * @param {object} at as `whyText` takes it, and `arrived`: when the newest state came, s; `hello`; `plan`
   * @param {number} now s
   */
  draw(at, now) {
    const { state, linked, mayDrive, hello } = at;
    document.body.dataset.link = linked ? "open" : "lost";
    document.body.dataset.may = mayDrive ? "drive" : hello ? "watch" : "";
    this._why(at, now);
    if (hello) write(byId("robot"), hello.robot);
    const mine = state?.page && state.page === at.me;
    document.body.dataset.drives = linked && mine ? "me" : "";
    const age = linked && state?.tick ? state.age + now - at.arrived : null;
    write(byId("age"), ageText(age));
    byId("age").classList.toggle("bad", age === null || age >= OLD);
    write(byId("driver"), state && linked ? driverText(state, at.me, mayDrive, at.input) : "");
    write(byId("armed"), state && linked ? armedText(state, at.me, at.input) : "");
    if (state) this._state(at, now);
  }

  _why(at, now) {
    const text = whyText(at);
    const stops = at.linked && (at.stopping || isStopped(at.state)); // what is said of a stop waits for nothing
    if (text === byId("why").textContent || (now - this._whyAt < SPOKEN && !stops)) return;
    this._whyAt = now;
    write(byId("why"), text);
    byId("status").classList.toggle("stopped", at.linked && isStopped(at.state));
    const fine = at.linked && at.mayDrive && !at.state?.why.what && !at.refused;
    byId("status").classList.toggle("fine", Boolean(fine && at.hold));
    byId("status").classList.toggle("bad", !at.linked && at.heard);
  }

  _state({ state, mayDrive, linked, plan }, now) {
    const shown = facts(state);
    for (const name of ["speed", "turn", "battery", "trip", "path"]) write(byId(name), linked ? shown[name] : "–");
    for (const [way, , unit] of DIRECTIONS) {
      const tile = byId(`way-${way}`);
      const word = linked ? clearance(state, way) : "unknown";
      tile.dataset.clearance = word;
      write(tile.querySelector(".word"), word);
      const verdict = state.directions?.[way];
      const moves = verdict && !["unknown", "stopped", "blocked"].includes(word);
      write(tile.querySelector(".most"), moves ? `${verdict.allowed.toFixed(2)} ${unit}` : "");
    }
    const said = mayDrive && !isStopped(state) ? state.why : null;
    writeList(byId("reasons"), linked ? reasons(state.directions, mayDrive, said) : []);
    byId("place").hidden = !(linked && state.map);
    if (state.map) write(byId("place"), placeText(state.map));
    if (now - this._floorAt < FLOOR_TEXT) return;
    this._floorAt = now;
    writeList(byId("floor-text"), linked ? floorLines(state, mayDrive, plan) : ["The link is lost: nothing is known of the robot."]);
  }
}
