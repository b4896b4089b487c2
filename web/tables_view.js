"use strict";
// Tables: goals, the plan and the log.

const STATE_MARKS = { done: "✓", now: "▶", failed: "✕", gone: "–", ahead: "○" };

class GoalsView {
  constructor(parent, model) {
    this.model = model;
    this.rows = new Map(); // by the goal's id
    this.only = () => true; // whether to show a goal
    this.buttons = () => []; // [text, function] of each button of a goal in a state
    this.open = new Set(); // ids of goals whose terms are shown
    this.body = html("tbody");
    const heads = ["goal", "state", "duration", "reason"].map((words) => html("th", { scope: "col" }, words));
    this.none = html("p", { class: "caption" }, "No goals yet.");
    show(parent, html("table", { class: "goals" }, html("thead", {}, html("tr", {}, heads)), this.body), this.none);
  }

  /** Update only changed texts of rows, so that no button disappears while it is pressed. */
  draw(time) {
    const rows = this.model.goals.filter((goal) => this.only(goal)).map((goal) => this.row(goal, this.model.goalAt(goal, time))).filter(Boolean);
    this.none.hidden = rows.length > 0;
    if (rows.length !== this.body.children.length || rows.some((row, number) => row !== this.body.children[number])) {
      show(this.body, rows);
    }
  }

  row(goal, state) {
    if (!state) return null;
    if (!this.rows.has(goal.id)) this.rows.set(goal.id, this.newRow(goal));
    const { row, name, word, waited, reason, acts } = this.rows.get(goal.id);
    const buttons = this.buttons(goal, state);
    redraw(acts, buttons.map(([text]) => text), () => buttons.map(([text, act]) => button(text, act, { "aria-label": `${text} ${goal.words}` })));
    const plain = [goal.request === goal.words ? "" : goal.request, state.details];
    const terms = plain.filter(Boolean).join("\n");
    redraw(name, [goal.words, terms], () => [folded(goal.words, terms, this.open, goal.id)]);
    say(word, this.model.said(state.word));
    word.className = `state ${state.word}`;
    say(waited, seconds(state.waited));
    say(reason, state.explained ? state.reason : "");
    return row;
  }

  newRow(goal) {
    const [word, waited, reason, acts] = [html("span"), html("td", { class: "number" }), html("span"), html("span", { class: "acts" })];
    const name = html("th", { scope: "row" });
    const last = html("td", {}, html("div", { class: "outcome" }, reason, acts));
    return { row: html("tr", {}, name, html("td", {}, word), waited, last), name, word, waited, reason, acts };
  }
}

const BEFORE = 3; // actions of a plan that are shown before the present one
const NEXT = 8; // and from it on; the others fold away

/** The plan of a moment; of the whole run, its overview. */
class PlanView {
  constructor(parent, model) {
    this.model = model;
    this.parent = parent;
    this.open = new Set(); // keys of what is unfolded
  }

  draw(time, whole = false) {
    const cycle = this.model.cycles[this.model.cycleAt(time)];
    const plan = this.model.planAt(time);
    const states = this.model.actionsAt(time).slice(-30).map((one) => one.state);
    const problems = cycle ? cycle.problems.filter(([at]) => at <= time).length : 0;
    const since = whole ? null : this.model.thinkingAt(time);
    const waits = since === null ? 0 : Math.floor(time - since);
    const known = plan && [plan.cycle.cycle, plan.number, plan.actions.map(({ words }) => words)];
    redraw(this.parent, [whole, cycle, known, states, problems, waits, whole ? time : this.model.beliefsAt(time)], () => {
      if (!cycle) return [html("p", { class: "caption" }, "No cycle has begun yet.")];
      if (whole) return [this.overview()];
      return [this.thinking(since, waits), this.plan(plan, cycle, time), this.problems(cycle, time), this.details(cycle, plan, time)];
    });
  }

  /** The whole run in figures. */
  overview() {
    const { ended, metres, total, longest, waits } = figures(this.model);
    const rows = [
      ["goals", ended || "none"],
      ["time", [seconds(this.model.seconds), this.model.paceWords()].filter(Boolean).join(", ")],
      waits.length ? ["goals took", spread(waits)] : null,
      ["actions", actionCounts(this.model)],
      metres === null ? null : ["driven", `${metres.toFixed(1)} m`],
      this.model.timed ? ["search for plans", `${brief(total)} of the solver, at most ${brief(longest)} for a cycle`] : null,
    ];
    return definitions(rows.filter(Boolean));
  }

  thinking(since, waits) {
    return since === null ? null : html("p", { class: "thinking", role: "status" }, `Searching for a plan for ${seconds(waits)}.`);
  }

  plan(found, cycle, time) {
    if (!found) return html("p", { class: "caption" }, "No plan yet.");
    const begun = this.model.begunAt(time, cycle.cycle);
    const items = found.actions.map((action) => {
      const one = begun.get(wordOf(action));
      const state = one ? one.state : action.cycle < cycle.cycle ? "done" : "ahead";
      const end = one && (one.state === "failed" || one.state === "gone") ? `: ${one.value}` : "";
      return [state, html("li", { class: state, value: action.cycle }, `${STATE_MARKS[state]} ${action.words}${end}`)];
    });
    if (!items.length) return html("p", {}, "Nothing to do.");
    const present = items.findIndex(([state]) => state === "now" || state === "ahead");
    const from = Math.max(0, (present < 0 ? items.length : present) - BEFORE);
    const [first, last] = [from > 1 ? from : 0, from + BEFORE + NEXT < items.length - 1 ? from + BEFORE + NEXT : items.length];
    const list = (some) => html("ol", { class: "plan" }, some.map(([, item]) => item));
    return [
      first ? fold(this.open, "earlier", count(first, "earlier action", "earlier actions"), list(items.slice(0, first))) : null,
      list(items.slice(first, last)),
      last < items.length ? fold(this.open, "later", count(items.length - last, "later action", "later actions"), list(items.slice(last))) : null,
    ];
  }

  problems(cycle, time) {
    const lines = cycle.problems.filter(([at]) => at <= time);
    const items = lines.map(([at, text, terms]) => html("li", {}, folded(text, terms, this.open, `${cycle.cycle} ${at} ${text}`)));
    return lines.length ? [html("h3", {}, "Messages"), html("ul", {}, items)] : null;
  }

  /** The cycle in the program's terms. */
  details(cycle, found, time) {
    const runs = this.model.about.run > 1 ? `, start ${cycle.run} of the core` : "";
    const atoms = this.model.beliefsAt(time);
    return fold(
      this.open,
      "details",
      "details",
      html("p", { class: "caption" }, `Cycle ${cycle.cycle}${runs}, since ${seconds(cycle.time)}. ${found ? planWords(found) : ""}`),
      found && found.actions.length ? [html("h3", {}, "Plan"), html("pre", {}, found.actions.map(({ term }) => term).join("\n"))] : null,
      [html("h3", {}, "Update"), html("pre", {}, cycle.updates.join("\n") || "none yet")],
      atoms.length ? [html("h3", {}, "Beliefs"), html("p", { class: "atoms" }, atoms.map((atom) => [html("code", {}, atom), " "]))] : null
    );
  }
}

function planWords({ plan, cycle, number }) {
  const times = plan.ground === null ? "" : `, grounding ${brief(plan.ground)}, searching ${brief(plan.solve)}`;
  const which = cycle.plans.length > 1 ? `, plan ${number + 1} of ${cycle.plans.length} in cycle ${cycle.cycle}` : "";
  return `Horizon ${plan.horizon}${times}${which}.`;
}

/** The numbers of actions by their ends. */
function actionCounts(model) {
  const states = model.actionsAt(model.seconds).map(({ state }) => state);
  const named = [["done", "done"], ["failed", "failed"], ["gone", "ended early"], ["now", "running"]];
  const parts = named.map(([state, words]) => [states.filter((one) => one === state).length, words]).filter(([number]) => number);
  return parts.map(([number, words]) => `${number} ${words}`).join(", ") || "none";
}

const LOG_LINES = 300;

/** The log around the present moment, with a limited number of lines, as browsers are slow; all lines for printing. */
class LogView {
  /** ``seek`` is called with the moment of a clicked line. */
  constructor(parent, model, seek) {
    this.model = model;
    this.seek = seek;
    this.list = html("ol", { class: "log", tabindex: "0", "aria-label": "Log of the run" });
    const more = (words, by) => button(words, () => this.show(this.first + by, LOG_LINES));
    this.earlier = more("Earlier lines", -LOG_LINES / 2);
    this.later = more("Later lines", LOG_LINES / 2);
    [this.first, this.past, this.known, this.now] = [0, 0, 0, -1];
    this.open = new Set(); // numbers of lines whose terms are shown
    window.addEventListener("beforeprint", () => this.show(0, this.model.log.length));
    show(parent, html("div", { class: "row tools" }, this.earlier, this.later), this.list);
  }

  /** Mark the line of a moment; of the whole run, none. */
  draw(time, whole = false) {
    const now = whole ? -1 : lastAt(this.model.log, time);
    const inside = now >= this.first && now < this.past;
    if (!inside || this.known !== this.model.log.length || this.log !== this.model.log) {
      this.log = this.model.log; // another one after the model was cleared
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
    show(this.list, this.model.log.slice(this.first, this.past).map((entry, number) => this.line(entry, this.first + number)));
    this.earlier.hidden = this.first === 0;
    this.later.hidden = this.past === all;
    this.later.parentNode.hidden = this.earlier.hidden && this.later.hidden;
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

  line({ time, cycle, kind, text, details }, number) {
    const moment = button(seconds(time), () => this.seek(time), { class: "moment" });
    return html(
      "li",
      { class: `entry ${kind}` },
      moment,
      html("span", { class: "number" }, `${cycle}`),
      html("span", { class: "kind" }, kind),
      html("span", { class: "text" }, folded(text, details, this.open, number))
    );
  }
}
