"use strict";
// Orders: a form for each kind of goal. The same browser can cancel its orders.

const MINE = "rosoclingo orders";

const FOLLOWED = 5;

/** The texts about an order, by the state of its goal. */
const BECAME = {
  succeeded: "Done", rejected: "Rejected", aborted: "Aborted", canceled: "Cancelled", lost: "Lost", waiting: "Ordered, queued",
};

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
  /** ``ask`` sends a message and calls a function with its answer. */
  constructor(parent, model, ask) {
    this.model = model;
    this.ask = ask;
    this.orders = new Orders();
    this.forms = html("div", { class: "forms" });
    this.said = html("div", { role: "status" });
    this.followed = []; // orders and faults of this page, the latest first: {goal, begun, line}
    this.shape = "";
    show(parent, this.forms, this.said);
  }

  /** Show the forms. A choice stays selected, even if it is temporarily unavailable. */
  draw(forms) {
    const shape = JSON.stringify(forms.map(({ title, fields }) => [title, fields.map(({ name }) => name)]));
    if (shape !== this.shape) {
      this.shape = shape;
      document.getElementById("asking").hidden = !forms.length;
      this.selects = forms.map(({ fields }, number) => new Map(fields.map(({ name }) => [name, this.select(name, number)])));
      show(this.forms, forms.map((form, number) => this.form(form, number)));
    }
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
    const button = html("button", { type: "submit", id: `order-${number}` }, "Order");
    const whole = html("form", { "aria-label": form.title }, html("strong", {}, form.title), fields, button);
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
    this.ask({ order: number, chosen, key: this.orders.kept.key }, (answer) => {
      if (answer.ordered) this.orders.add(answer.ordered);
      this.note(answer.ordered, answer.fault ? `Not ordered: ${answer.fault}` : answer.text, "Ordered");
    });
  }

  cancel(goal) {
    this.ask({ cancel: goal.id, key: this.orders.kept.key }, (answer) => {
      this.note(answer.canceled, answer.fault ? `Not cancelled: ${answer.fault}` : goal.request, "Cancel requested");
    });
  }

  /** Track a goal, or show why there is none. */
  note(goal, text, begun) {
    const others = this.followed.filter((one) => one.goal && one.goal !== goal);
    this.followed = [{ goal, text, begun, line: html("p", { class: "caption" }, goal ? `${begun}: ${text}` : text) }, ...others].slice(0, FOLLOWED);
    show(this.said, this.followed.map(({ line }) => line));
    this.follow();
  }

  /** Show the outcome of the latest orders. */
  follow() {
    const goals = new Map(this.model.goals.map((goal) => [goal.id, goal]));
    for (const { goal, text, begun, line } of this.followed) {
      const found = goals.get(goal);
      if (!found) continue; // not reported yet, or dropped long ago
      const [, word, reason] = found.states[found.states.length - 1];
      const why = reason && !["pending", "active", "canceling", "succeeded", "canceled"].includes(word) ? ` (${reason})` : "";
      say(line, `${BECAME[word] || begun}: ${text}${why}`);
    }
  }
}
