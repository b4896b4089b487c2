"use strict";
// Orders and facts: a form for each kind, and below them the orders of this browser, which it can cancel.

const MINE = "rosoclingo orders";

const ENDED_SHOWN = 5;

/** A text with a capital letter at its beginning. */
function capital(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** This browser's stored data: its key, and the ids of its goals. */
class Orders {
  constructor() {
    const [found, fresh] = [this.stored(), { key: window.crypto.getRandomValues(new Uint32Array(4)).join("-"), goals: [] }];
    this.kept = found && typeof found.key === "string" && Array.isArray(found.goals) ? found : fresh;
  }

  stored() {
    try {
      return JSON.parse(window.localStorage.getItem(MINE));
    } catch (error) {
      return null; // storage can be forbidden; the data then lasts for this page only
    }
  }

  add(goal) {
    this.kept.goals = [...this.kept.goals, goal].slice(-200);
    try {
      window.localStorage.setItem(MINE, JSON.stringify(this.kept));
    } catch (error) {
      // as above
    }
  }

  has(goal) {
    return this.kept.goals.includes(goal);
  }
}

class OrdersView {
  /** ``ask`` sends a message and calls a function with its answer; ``notices`` shows messages and explanations. */
  constructor(parent, model, ask, notices) {
    this.model = model;
    this.orders = new Orders();
    this.ask = (message, then) => ask({ ...message, key: this.orders.kept.key }, then);
    this.notices = notices;
    this.forms = html("div", { class: "forms" });
    this.own = html("div", { hidden: true });
    this.states = new Map(); // the last state of each of this browser's goals
    this.facts = []; // the facts that were sent: {text, words, line (of the log)}
    const table = html("div", { class: "scroll" });
    show(parent, this.forms, this.own);
    show(this.own, html("h3", {}, "My orders"), table);
    this.mine = new GoalsView(table, model);
    this.mine.only = (goal) => this.listed.has(goal.id);
    this.mine.buttons = (goal, state) => [
      ...(state.open && state.word !== "canceling" ? [["Cancel", () => this.cancel(goal)]] : []),
      ...this.questions(goal, state),
    ];
  }

  /** Show the forms. A choice stays selected, even if it is temporarily unavailable. */
  draw(forms) {
    redraw(this.forms, forms.map(({ title, fields }) => [title, fields.map(({ name }) => name)]), () => {
      document.getElementById("asking").hidden = !forms.length;
      this.selects = forms.map(({ fields }, number) => new Map(fields.map(({ name }) => [name, this.select(name, number)])));
      return forms.map((form, number) => this.form(form, number));
    });
    this.offered = forms;
    forms.forEach((_form, number) => this.offer(number));
    this.follow();
  }

  select(name, number) {
    const select = html("select", { id: `order-${number}-${name}`, name });
    select.addEventListener("change", () => this.offer(number));
    return select;
  }

  form(form, number) {
    const fields = [...this.selects[number]].map(([name, select]) => html("label", {}, `${name} `, select));
    const button = html("button", { type: "submit", id: `order-${number}` }, form.fact ? "Report" : "Order");
    const whole = html("form", { "aria-label": form.title, class: form.fact ? "fact" : null }, html("strong", {}, form.title), fields, button);
    whole.addEventListener("submit", (event) => {
      event.preventDefault();
      this.order(number, Object.fromEntries([...this.selects[number]].map(([name, select]) => [name, select.value])));
    });
    return whole;
  }

  /** Update the options of a form, without places chosen in other fields. */
  offer(number) {
    const selects = this.selects[number];
    const fields = this.offered[number].fields;
    for (const { name, options, apart } of [...fields.filter((one) => !one.apart), ...fields.filter((one) => one.apart)]) {
      const taken = (apart || []).map(({ field, places }) => (places ? places[selects.get(field).value] : selects.get(field).value));
      this.renew(selects.get(name), options.filter(([value]) => !taken.includes(value)));
    }
  }

  /** Replace a select's options in place, preserving its choice. */
  renew(select, options) {
    const [chosen, before] = [select.value, [...select.options]];
    const known = new Map(before.map((option) => [option.value, option]));
    const gone = chosen !== "" && !options.some(([value]) => value === chosen);
    const after = [...options, ...(gone ? [[chosen, `${chosen} (not now)`]] : [])].map(([value, words]) => {
      const option = known.get(value) || html("option", { value });
      say(option, words);
      option.disabled = gone && value === chosen;
      return option;
    });
    if (after.length === before.length && after.every((option, place) => option === before[place])) return;
    select.replaceChildren(...after);
    if (chosen !== "") select.value = chosen;
  }

  order(number, chosen) {
    this.ask({ order: number, chosen }, ({ fault, ordered, reported, text, words }) => {
      if (fault) {
        this.notices.say(`Not sent: ${fault}`, true);
        return;
      }
      if (ordered) {
        this.orders.add(ordered);
        this.states.set(ordered, "");
      }
      if (reported) this.facts.push({ text, words, line: this.model.log.length });
      this.notices.say(`${ordered ? "Ordered" : "Reported"}: ${words}`, false, ordered);
      this.follow(); // the goal's state can have arrived before this answer
    });
  }

  cancel(goal) {
    this.ask({ cancel: goal.id }, ({ fault }) => {
      if (fault) this.notices.say(`Not cancelled: ${fault}`, true);
    });
  }

  /** The button that asks why a goal is not met, if there is a reason to ask. */
  questions(goal, { word, explained }) {
    return explained || word === "pending" ? [["Why?", () => this.explain(goal)]] : [];
  }

  explain(goal) {
    this.notices.explain(goal.words, ["One moment …"]);
    this.ask({ why: goal.id }, ({ fault, why, details }) => this.notices.explain(goal.words, fault ? [fault] : why, details));
  }

  /** Show this browser's goals, and report the changes of their states. */
  follow() {
    const own = this.model.goals.filter((goal) => goal && this.orders.has(goal.id));
    const ended = own.filter((goal) => goal.ended !== null).slice(-ENDED_SHOWN);
    this.listed = new Set([...own.filter((goal) => goal.ended === null), ...ended].map((goal) => goal.id));
    this.own.hidden = !this.listed.size;
    this.mine.draw(this.model.seconds);
    for (const goal of own) this.announce(goal);
    this.facts = this.facts.filter((fact) => this.model.log.length < fact.line + 100 && !this.isIgnored(fact));
  }

  /** Report that a goal has ended or is queued. */
  announce(goal) {
    const { word, reason, open, failed, explained } = this.model.goalAt(goal, Infinity);
    const before = this.states.get(goal.id);
    this.states.set(goal.id, word);
    if (before === undefined || before === word || (open && !explained)) return; // ``undefined``: before this page was opened
    const why = reason && explained ? ` (${reason})` : "";
    this.notices.say(`${capital(this.model.said(word))}: ${goal.words}${why}`, failed, goal.id);
  }

  /** Return whether the core's log reports that it ignores a fact, and show that. */
  isIgnored({ text, words, line }) {
    const [begin] = text.split("now");
    const found = this.model.log.slice(line).find(({ kind, text: note, details }) => kind === "note" && `${note} ${details}`.includes(begin));
    if (found) this.notices.say(`${words}: ${found.text}`, true);
    return Boolean(found);
  }
}
