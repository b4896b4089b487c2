"use strict";
// Tables: goals, the present cycle and the log.

const STATE_MARKS = { done: "✓", now: "▶", failed: "✕", gone: "–", ahead: "○" };

class GoalsView {
  constructor(parent, model) {
    this.model = model;
    this.rows = new Map(); // by the goal's id
    this.mine = () => false; // whether this page can cancel a goal, and the function that does
    this.cancel = () => undefined;
    this.body = html("tbody");
    const heads = ["goal", "state", "since it was sent", "reason"].map((words) => html("th", { scope: "col" }, words));
    this.none = html("p", { class: "caption" }, "No goals yet.");
    show(parent, html("table", { class: "goals" }, html("thead", {}, html("tr", {}, heads)), this.body), this.none);
  }

  /** Update only changed texts of rows, so that no button disappears while it is pressed. */
  draw(time) {
    const rows = this.model.goals.map((goal) => this.row(goal, this.model.goalAt(goal, time))).filter(Boolean);
    this.none.hidden = rows.length > 0;
    if (rows.length !== this.body.children.length || rows.some((row, number) => row !== this.body.children[number])) {
      show(this.body, rows);
    }
  }

  row(goal, state) {
    if (!state) return null;
    if (!this.rows.has(goal.id)) this.rows.set(goal.id, this.newRow(goal));
    const { row, name, word, waited, reason, terms, last, cancel } = this.rows.get(goal.id);
    const offered = goal.ended === null && state.word !== "canceling" && this.mine(goal);
    if (offered && !cancel.isConnected) last.append(cancel);
    if (!offered) cancel.remove();
    const speaks = !["pending", "active", "canceling", "succeeded", "canceled"].includes(state.word); // the others need no words
    say(name, goal.words);
    say(word, this.model.said(state.word));
    word.className = `state ${state.word}`;
    say(waited, seconds(state.waited));
    say(reason, speaks ? state.reason : "");
    say(terms, [goal.request, speaks ? state.details : ""].filter(Boolean).join("\n"));
    return row;
  }

  newRow(goal) {
    const [word, waited, reason] = [html("span"), html("td", { class: "number" }), html("span")];
    const cancel = html("button", { type: "button", onclick: () => this.cancel(goal) }, "Cancel");
    cancel.setAttribute("aria-label", `Cancel ${goal.words}`);
    const [name, terms] = [html("span"), html("code")];
    const head = html("th", { scope: "row" }, name, html("details", {}, html("summary", {}, "details"), terms));
    const last = html("td", {}, reason);
    return { row: html("tr", {}, head, html("td", {}, word), waited, last), name, word, waited, reason, terms, last, cancel };
  }
}

class CycleView {
  constructor(parent, model) {
    this.model = model;
    this.parent = parent;
    this.shown = null;
  }

  draw(time) {
    const cycle = this.model.cycles[this.model.cycleAt(time)];
    const plan = this.model.planAt(time);
    const states = this.model.actionsAt(time).slice(-30).map((one) => one.state);
    const problems = cycle ? cycle.problems.filter(([at]) => at <= time).length : 0;
    const what = JSON.stringify([cycle, plan && [plan.cycle.cycle, plan.number], states, problems, this.model.beliefsAt(time)]);
    if (what === this.shown) return; // preserves the scroll position
    this.shown = what;
    if (!cycle) {
      show(this.parent, html("p", { class: "caption" }, "No cycle has begun yet."));
      return;
    }
    const runs = this.model.about.run > 1 ? `, start ${cycle.run} of the core` : "";
    show(
      this.parent,
      html("p", { class: "caption" }, `Cycle ${cycle.cycle}${runs}, since ${seconds(cycle.time)}`),
      html("h3", {}, "Update"),
      html("pre", {}, cycle.updates.join("\n") || "none yet"),
      this.plan(time),
      this.problems(cycle, time),
      this.beliefs(time)
    );
  }

  plan(time) {
    const found = this.model.planAt(time);
    if (!found) return null;
    const { plan, cycle } = found;
    const begun = this.model.begunAt(time, cycle.cycle);
    const items = found.actions.map((action) => {
      const one = begun.get(wordOf(action));
      const state = one ? one.state : action.cycle < cycle.cycle ? "done" : "ahead";
      const end = one && (one.state === "failed" || one.state === "gone") ? `: ${one.value}` : "";
      return html("li", { class: state, value: action.cycle }, `${STATE_MARKS[state]} ${action.words}${end}`);
    });
    const times = plan.ground === null ? "" : `; grounding ${brief(plan.ground)}, searching ${brief(plan.solve)}`;
    const which = cycle.plans.length > 1 ? `; plan ${found.number + 1} of ${cycle.plans.length} in cycle ${cycle.cycle}` : "";
    const list = items.length ? html("ol", { class: "plan" }, items) : html("p", {}, "Nothing to do.");
    return [html("h3", {}, "Plan"), list, html("p", { class: "caption" }, `Horizon ${plan.horizon}${times}${which}.`)];
  }

  problems(cycle, time) {
    const lines = cycle.problems.filter(([at]) => at <= time).map(([, text, terms]) => html("li", {}, text, details(terms)));
    return lines.length ? [html("h3", {}, "Log"), html("ul", {}, lines)] : null;
  }

  beliefs(time) {
    const atoms = this.model.beliefsAt(time);
    if (!atoms.length) return null;
    return [html("h3", {}, "Beliefs"), html("p", { class: "atoms" }, atoms.map((atom) => [html("code", {}, atom), " "]))];
  }
}

const LOG_LINES = 300;

/** The log around the present moment, with a limited number of lines, as browsers are slow; all lines for printing. */
class LogView {
  /** ``seek`` is called with the moment of a clicked line. */
  constructor(parent, model, seek) {
    this.model = model;
    this.seek = seek;
    this.list = html("ol", { class: "log", tabindex: "0", "aria-label": "Log of the run" });
    const more = (words, by) => html("button", { type: "button", onclick: () => this.show(this.first + by, LOG_LINES) }, words);
    this.earlier = more("Earlier lines", -LOG_LINES / 2);
    this.later = more("Later lines", LOG_LINES / 2);
    [this.first, this.past, this.known, this.now] = [0, 0, 0, -1];
    window.addEventListener("beforeprint", () => this.show(0, this.model.log.length));
    show(parent, html("div", { class: "row tools" }, this.earlier, this.later), this.list);
  }

  draw(time) {
    const now = lastAt(this.model.log, time);
    const inside = now >= this.first && now < this.past;
    if (!inside || this.known !== this.model.log.length || this.born !== this.model.born) {
      this.born = this.model.born;
      this.now = now;
      this.show(inside ? this.first : now - LOG_LINES / 2, LOG_LINES);
    } else if (now !== this.now) {
      this.mark(now);
    }
  }

  /** Show a limited number of lines from ``first`` on. */
  show(first, lines) {
    const all = this.model.log.length;
    this.known = all;
    this.first = Math.max(0, Math.min(Math.round(first), all - lines));
    this.past = Math.min(all, this.first + lines);
    show(this.list, this.model.log.slice(this.first, this.past).map((entry) => this.line(entry)));
    this.earlier.hidden = this.first === 0;
    this.later.hidden = this.past === all;
    this.mark(this.now);
  }

  mark(now) {
    const old = this.list.querySelector("[aria-current]");
    if (old) old.removeAttribute("aria-current");
    this.now = now;
    const line = this.list.children[now - this.first];
    if (!line) return;
    line.setAttribute("aria-current", "true");
    const [top, room] = [line.offsetTop, this.list.clientHeight];
    if (top < this.list.scrollTop || top + line.offsetHeight > this.list.scrollTop + room) {
      this.list.scrollTop = top - room / 2;
    }
  }

  line({ time, cycle, kind, text, details: terms }) {
    const moment = html("button", { type: "button", class: "moment", onclick: () => this.seek(time) }, `${time.toFixed(1)} s`);
    return html(
      "li",
      { class: `entry ${kind}` },
      moment,
      html("span", { class: "number" }, `${cycle}`),
      html("span", { class: "kind" }, kind),
      html("span", { class: "text" }, text, details(terms))
    );
  }
}
