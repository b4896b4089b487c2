"use strict";
// Timeline of goals and actions: finished, running and planned, and of the searches for plans.

const LANE = 26;
const MOST_ROWS = 8; // of goals
const MOST_LANES = 16; // of robots, or of kinds of actions
const LONG = 0.5; // seconds from which a search is drawn

class TimelineView {
  /** ``seek`` is called with a clicked moment. */
  constructor(parent, model, seek) {
    this.model = model;
    this.seek = seek;
    this.picture = svg("svg", { class: "timeline", role: "img", "aria-label": "Goals and actions over time; the tables contain the same data" });
    this.zoom = html("select", { "aria-label": "Part of the run that the timeline shows" });
    for (const [value, words] of [["0", "whole run"], ["60", "1 minute"], ["180", "3 minutes"], ["900", "15 minutes"]]) {
      this.zoom.append(html("option", { value }, words));
    }
    this.chosen = false;
    this.zoom.addEventListener("change", () => {
      this.chosen = true;
      this.draw(this.time, this.whole);
    });
    this.picture.addEventListener("click", (event) => this.clicked(event));
    const key = [["done", "done"], ["now", "running"], ["failed", "failed"], ["gone", "ended early"], ["ahead", "planned"], ["thinking", "search for a plan"]];
    const keys = key.map(([name, words]) => html("span", { class: `key ${name}` }, words));
    this.cut = html("p", { class: "caption" });
    show(parent, html("div", { class: "row tools" }, this.zoom, html("span", { class: "keys" }, keys)), this.picture, this.cut);
  }

  clicked(event) {
    const x = event.clientX - this.picture.getBoundingClientRect().left;
    if (x >= this.left) this.seek(this.from + ((x - this.left) / (this.width - this.left)) * (this.to - this.from));
  }

  /** Draw the run up to a moment; ``whole``: the moment is the end, and the whole run is shown. */
  draw(time, whole = false) {
    [this.time, this.whole, this.robots] = [time, whole, this.model.robotNames];
    this.width = this.picture.clientWidth || 700;
    this.left = this.width < 500 ? 84 : 120;
    const planned = whole ? [] : this.planned(time);
    this.span(time, planned, whole);
    const rows = this.goalRows(time);
    const thinking = this.thinking(time);
    const all = this.laneNames();
    const lanes = all.slice(0, MOST_LANES);
    const top = (rows.length + (thinking.length ? 1 : 0)) * LANE;
    const height = top + lanes.length * LANE + 30;
    this.picture.setAttribute("viewBox", `0 0 ${this.width} ${height}`);
    this.picture.setAttribute("height", height);
    const goals = rows.map((row, number) => row.map((goal) => this.goal(goal, number * LANE, time)));
    const names = lanes.map((name, number) => this.lane(name, top + number * LANE));
    const under = rows.length * LANE;
    const searches = thinking.map((one) => this.search(one, under));
    const bars = this.model.actionsAt(time).map((one) => this.action(one, lanes, top, time));
    const ahead = planned.map((one) => this.ahead(one, lanes, top));
    const cursor = svg("line", { class: "cursor", x1: this.x(time), x2: this.x(time), y1: 0, y2: height - 22 });
    const heads = [rows.length ? this.name("goals", 0) : null, thinking.length ? this.lane("search", under) : null];
    show(this.picture, hatched(), this.axis(height), goals, heads, names, searches, bars, ahead, whole ? null : cursor);
    this.cut.hidden = all.length === lanes.length;
    say(this.cut, `Not shown: ${all.slice(MOST_LANES).join(", ")}.`);
  }

  /** The visible part of the run, with space for planned actions. */
  span(time, planned, all) {
    if (!this.chosen) this.zoom.value = !all && this.model.seconds > 240 ? "180" : "0";
    const wanted = Number(this.zoom.value);
    const whole = Math.max(this.model.seconds, 1);
    const needed = Math.max(time, ...planned.map(({ ended }) => ended));
    if (!wanted) {
      [this.from, this.to] = [0, Math.max(whole, Math.min(needed, time + whole)) * 1.01];
      return;
    }
    this.from = Math.max(0, Math.min(time - wanted * 0.6, whole - wanted));
    this.to = Math.max(this.from + wanted, Math.min(needed, time + wanted / 2));
  }

  x(time) {
    return this.left + ((time - this.from) / (this.to - this.from)) * (this.width - this.left - 4);
  }

  axis(height) {
    return moments(this.from, this.to, this.width / 120).map(([at, words]) => [
      svg("line", { class: "grid", x1: this.x(at), x2: this.x(at), y1: 0, y2: height - 22 }),
      svg("text", { class: this.x(at) > this.width - 30 ? "tick end" : "tick", x: this.x(at), y: height - 6 }, words),
    ]);
  }

  name(text, top, name = "lane") {
    const room = Math.floor(this.left / 7);
    return svg("text", { class: name, x: 0, y: top + LANE / 2 + 4 }, short(text, room), svg("title", {}, text));
  }

  lane(name, top) {
    const colour = this.robots.includes(name) ? `lane robotname ${this.model.colour(name)}` : "lane";
    return [svg("line", { class: "grid", x1: 0, x2: this.width, y1: top, y2: top }), this.name(name, top, colour)];
  }

  /** The lanes: the robots if there are several, and the kinds of other actions. */
  laneNames() {
    const found = new Set(this.model.words.flatMap((action) => this.lanesOf(action)));
    return [...this.robots.filter((robot) => found.has(robot)), ...[...found].filter((name) => !this.robots.includes(name))];
  }

  /** The lanes of an action: one for each of its robots, else that of its kind. */
  lanesOf(action) {
    const known = action.robots.filter((robot) => this.robots.includes(robot));
    return known.length ? known : [action.kind];
  }

  /** Visible goals in the fewest rows; goals beyond the last row share it. */
  goalRows(time) {
    const rows = [];
    for (const goal of this.model.goals) {
      const state = this.model.goalAt(goal, time);
      const end = state && !state.open ? goal.ended : time;
      if (!state || end < this.from || goal.sent > this.to) continue;
      const free = rows.find((row) => row[row.length - 1].end <= goal.sent);
      const one = { goal, state, end };
      if (free) free.push(one);
      else if (rows.length < MOST_ROWS) rows.push([one]);
      else rows[rows.length - 1].push(one);
    }
    return rows;
  }

  /** A bar with words, or with ``fewer`` if they do not fit. */
  bar(from, to, top, name, words, whole, fewer = words) {
    const [left, right] = [Math.max(this.left, this.x(from)), Math.min(this.width, this.x(to))];
    if (right < this.left || left > this.width) return null;
    const width = Math.max(2, right - left - 1);
    const room = Math.floor(width / 7.2);
    const said = short(words.length > room ? fewer : words, room);
    const text = room > 2 ? svg("text", { class: "barname", x: left + 4, y: top + LANE / 2 + 4 }, said) : null;
    const box = svg("rect", { x: left, y: top + 3, width, height: LANE - 6, rx: 4 });
    return svg("g", { class: `bar ${name}` }, box, text, svg("title", {}, whole || words));
  }

  goal({ goal, state, end }, top, time) {
    const name = state.open ? "now" : state.failed ? "failed" : state.word === "succeeded" ? "done" : "gone";
    const whole = `${goal.words}: ${this.model.said(state.word)}${state.reason ? ` (${state.reason})` : ""}, ${seconds(state.waited)}`;
    return this.bar(goal.sent, Math.max(end, state.open ? time : end), top, name, goal.words, whole);
  }

  /** The bars of an action: its words without the robot in its lane, the parameter in the lane of its kind or without room. */
  deeds(action, from, to, lanes, top, name, whole) {
    const parameter = this.model.title(action.parameter) || action.words;
    const shown = this.lanesOf(action).filter((lane) => lanes.includes(lane));
    return shown.map((lane) => this.bar(from, to, top + lanes.indexOf(lane) * LANE, name, lane === action.kind ? parameter : action.deed, whole, parameter));
  }

  action(one, lanes, top, time) {
    const end = one.state === "now" ? time : one.ended;
    const became = one.state === "now" ? "running" : one.state === "done" ? "done" : one.value;
    const whole = `${one.word.words}: ${became}, ${seconds(end - one.begun)}`;
    return this.deeds(one.word, one.begun, end, lanes, top, one.state, whole);
  }

  /** The actions of the plan, each as long as such actions took, after those of earlier cycles of its robots: {action, begun, ended}. */
  planned(time) {
    const usual = this.model.usualAt(time);
    const busy = new Map(); // by robot: the cycle of its last action, and when it and the one before end
    const place = (action, cycle, begun) => {
      const mine = (action.robots.length ? action.robots : [""]).map((robot) => [robot, busy.get(robot) || { cycle: 0, begun: 0, ended: 0 }]);
      const from = Math.max(begun, ...mine.map(([, last]) => (last.cycle === cycle ? last.begun : last.ended)));
      const ended = from + usual(action);
      for (const [robot, last] of mine) busy.set(robot, { cycle, begun: from, ended: Math.max(last.ended, ended, time) });
      return { action, begun: from, ended };
    };
    for (const one of this.model.runningAt(time)) place(one.word, -1, one.begun);
    return this.model.aheadAt(time).map((action) => place(action, action.cycle, time));
  }

  ahead({ action, begun, ended }, lanes, top) {
    const whole = `planned: ${action.words} in cycle ${action.cycle}, about ${seconds(ended - begun)}`;
    return this.deeds(action, begun, ended, lanes, top, "ahead", whole);
  }

  /** The long searches, and the one that goes on. */
  thinking(time) {
    const found = this.model.searchesAt(time).filter(({ begun, ended, wall }) => ended - begun >= LONG || wall >= 2 * LONG);
    const since = this.model.thinkingAt(time);
    return since === null ? found : [...found, { begun: since, ended: time, wall: null }];
  }

  search({ begun, ended, wall }, top) {
    const words = wall === null ? `${seconds(ended - begun)} until now` : brief(wall);
    return this.bar(begun, ended, top, "thinking", words, `search for a plan: ${words}${wall === null ? "" : " of the solver"}`);
  }
}

/** The pattern of planned bars. */
function hatched() {
  const lines = svg("path", { class: "hatch", d: "M -2 8 L 8 -2 M 3 13 L 13 3" });
  return svg("defs", {}, svg("pattern", { id: "hatched", width: 10, height: 10, patternUnits: "userSpaceOnUse" }, lines));
}
