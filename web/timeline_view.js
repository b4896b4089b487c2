"use strict";
// Timeline of goals and actions: finished, running and planned.

const LANE = 26;
const MOST_LANES = 8;

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
      this.draw(this.time);
    });
    this.picture.addEventListener("click", (event) => this.clicked(event));
    const key = [["done", "done"], ["now", "running"], ["failed", "failed"], ["gone", "ended early"], ["ahead", "planned"]];
    const keys = key.map(([name, words]) => html("span", { class: `key ${name}` }, words));
    show(parent, html("div", { class: "row tools" }, this.zoom, html("span", { class: "keys" }, keys)), this.picture);
  }

  clicked(event) {
    const x = event.clientX - this.picture.getBoundingClientRect().left;
    if (x >= this.left) this.seek(this.from + ((x - this.left) / (this.width - this.left)) * (this.to - this.from));
  }

  draw(time) {
    this.time = time;
    this.width = this.picture.clientWidth || 700;
    this.left = this.width < 500 ? 74 : 110;
    const ahead = this.model.aheadAt(time);
    this.span(time, ahead.length);
    const lanes = [...new Set([...this.model.words.map((word) => word.interface)])].slice(0, MOST_LANES);
    const rows = this.goalRows(time);
    const height = (rows.length + lanes.length) * LANE + 30;
    this.picture.setAttribute("viewBox", `0 0 ${this.width} ${height}`);
    this.picture.setAttribute("height", height);
    const goals = rows.map((row, number) => row.map((goal) => this.goal(goal, number * LANE, time)));
    const top = rows.length * LANE;
    const actions = lanes.map((name, number) => this.lane(name, top + number * LANE));
    const bars = this.model.actionsAt(time).map((one) => this.action(one, lanes, top, time));
    const cursor = svg("line", { class: "cursor", x1: this.x(time), x2: this.x(time), y1: 0, y2: height - 22 });
    show(this.picture, this.axis(height), goals, rows.length ? this.name("goals", 0) : null, actions, bars, this.planned(ahead, lanes, top, time), cursor);
  }

  /** The visible part of the run, with space for planned actions. */
  span(time, ahead) {
    if (!this.chosen) this.zoom.value = this.model.seconds > 240 ? "180" : "0";
    const wanted = Number(this.zoom.value);
    const whole = Math.max(this.model.seconds, 1);
    if (!wanted) {
      [this.from, this.to] = [0, Math.max(whole, time + (ahead ? whole / 3 : 0)) * 1.01];
      return;
    }
    this.from = Math.max(0, Math.min(time - wanted * 0.6, whole - wanted));
    this.to = Math.max(this.from + wanted, time + (ahead ? wanted / 3 : 0));
  }

  x(time) {
    return this.left + ((time - this.from) / (this.to - this.from)) * (this.width - this.left - 4);
  }

  axis(height) {
    return marks(this.from, this.to, this.width / 110).map((at) => [
      svg("line", { class: "grid", x1: this.x(at), x2: this.x(at), y1: 0, y2: height - 22 }),
      svg("text", { class: "tick", x: this.x(at), y: height - 6 }, `${at} s`),
    ]);
  }

  name(text, top) {
    const room = Math.floor(this.left / 7.5);
    return svg("text", { class: "lane", x: 0, y: top + LANE / 2 + 4 }, short(text, room), svg("title", {}, text));
  }

  lane(name, top) {
    return [svg("line", { class: "grid", x1: 0, x2: this.width, y1: top, y2: top }), this.name(name, top)];
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
      else if (rows.length < MOST_LANES) rows.push([one]);
      else rows[rows.length - 1].push(one);
    }
    return rows;
  }

  bar(from, to, top, name, words, whole) {
    const [left, right] = [Math.max(this.left, this.x(from)), Math.min(this.width, this.x(to))];
    if (right < this.left || left > this.width) return null;
    const width = Math.max(2, right - left - 1);
    const room = Math.floor(width / 7.2);
    const text = room > 2 ? svg("text", { class: "barname", x: left + 4, y: top + LANE / 2 + 4 }, short(words, room)) : null;
    const box = svg("rect", { x: left, y: top + 3, width, height: LANE - 6, rx: 4 });
    return svg("g", { class: `bar ${name}` }, box, text, svg("title", {}, whole || words));
  }

  goal({ goal, state, end }, top, time) {
    const name = state.open ? "now" : state.word === "succeeded" ? "done" : state.word === "canceled" ? "gone" : "failed";
    const whole = `${goal.words}: ${this.model.said(state.word)}${state.reason ? ` (${state.reason})` : ""}, ${seconds(state.waited)}`;
    return this.bar(goal.sent, Math.max(end, state.open ? time : end), top, name, goal.words, whole);
  }

  action(one, lanes, top, time) {
    const lane = lanes.indexOf(one.word.interface);
    if (lane < 0) return null;
    const end = one.state === "now" ? time : one.ended;
    const whole = `${one.word.words}: ${one.state === "now" ? "running" : one.state === "done" ? "done" : one.value}, ${seconds(end - one.begun)}`;
    return this.bar(one.begun, end, top + lane * LANE, one.state, one.word.parameter || one.word.interface, whole);
  }

  planned(ahead, lanes, top, time) {
    if (!ahead.length) return null;
    const slot = (this.to - time) / Math.max(ahead.length, 4);
    return ahead.map((action, number) => {
      const lane = lanes.indexOf(action.interface);
      const begin = time + number * slot;
      if (lane < 0) return null;
      return this.bar(begin, begin + slot, top + lane * LANE, "ahead", action.parameter, `planned: ${action.words} in cycle ${action.cycle}`);
    });
  }
}
