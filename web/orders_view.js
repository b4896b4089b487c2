"use strict";
// What people may order: a form for each kind of goal. What was ordered in this browser can be cancelled in it.

const MINE = "rosoclingo orders";

/** What this browser keeps: its key, and the ids of the goals that it has ordered. */
class Orders {
  constructor() {
    const [found, fresh] = [this.stored(), { key: window.crypto.getRandomValues(new Uint32Array(4)).join("-"), goals: [] }];
    this.kept = found && typeof found.key === "string" && Array.isArray(found.goals) ? found : fresh;
  }

  stored() {
    try {
      return JSON.parse(window.localStorage.getItem(MINE));
    } catch (error) {
      return null; // it may be forbidden: then it lasts as long as the page
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
  /** ``ask`` sends a message and is given what is to be done with its answer. */
  constructor(parent, ask) {
    this.ask = ask;
    this.orders = new Orders();
    this.forms = html("div", { class: "forms" });
    this.said = html("p", { class: "caption", role: "status" });
    this.known = "";
    show(parent, this.forms, this.said);
  }

  /** Show the forms; those that are as they were keep what was chosen. */
  draw(forms) {
    const known = JSON.stringify(forms);
    if (known === this.known) return;
    this.known = known;
    document.getElementById("asking").hidden = !forms.length;
    const chosen = new Map([...this.forms.querySelectorAll("select")].map((one) => [one.id, one.value]));
    const focus = document.activeElement && document.activeElement.id;
    show(this.forms, forms.map((form, number) => this.form(form, number, chosen)));
    const again = focus && document.getElementById(focus);
    if (again && this.forms.contains(again)) again.focus();
  }

  form(form, number, chosen) {
    const fields = form.fields.map(({ name, options }) => {
      const id = `order-${number}-${name}`;
      const select = html("select", { id, name }, options.map(([value, words]) => html("option", { value }, words)));
      if (options.some(([value]) => value === chosen.get(id))) select.value = chosen.get(id);
      return html("label", {}, `${name} `, select);
    });
    const button = html("button", { type: "submit", id: `order-${number}` }, "Order");
    const whole = html("form", { "aria-label": form.title }, html("strong", {}, form.title), fields, button);
    whole.addEventListener("submit", (event) => {
      event.preventDefault();
      this.order(number, Object.fromEntries([...whole.querySelectorAll("select")].map((one) => [one.name, one.value])));
    });
    return whole;
  }

  order(number, chosen) {
    this.ask({ order: number, chosen, key: this.orders.kept.key }, (answer) => {
      if (answer.ordered) this.orders.add(answer.ordered);
      this.said.textContent = answer.fault ? `Not ordered: ${answer.fault}` : `Ordered: ${answer.text}`;
    });
  }

  cancel(goal) {
    this.ask({ cancel: goal.id, key: this.orders.kept.key }, (answer) => {
      this.said.textContent = answer.fault ? `Not cancelled: ${answer.fault}` : `Cancelled: ${goal.request}`;
    });
  }
}
