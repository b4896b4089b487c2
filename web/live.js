"use strict";
// The live page of a running system. Changes arrive over a WebSocket, which reconnects after a loss.

const RETRY = { first: 500, most: 5000 }; // ms

/** The present state of the system, which a message has if it has changed. */
const STATE = ["core", "mode", "health", "orders", "operates"];

class Live {
  constructor() {
    this.model = new RunModel();
    this.player = new Player(this.model, true);
    this.player.map.offerScans(() => this.ask({ scan: true }, () => undefined));
    this.wait = RETRY.first;
    this.answers = new Map(); // callbacks for answers, by the number of the message
    this.asked = 0;
    this.state = { core: false, mode: "running", health: [], orders: [], operates: false };
    const part = (name) => document.getElementById(name);
    const notices = new Notices(part("messages"), part("dialog"));
    this.orders = new OrdersView(part("orders"), this.model, (message, then) => this.ask(message, then), notices);
    this.operator = new OperatorView(this.model, this.orders.ask, notices);
    this.player.goals.buttons = (goal, state) => this.orders.questions(goal, state);
    this.connect();
  }

  connect() {
    const secure = window.location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${secure}//${window.location.host}/run`);
    this.socket.addEventListener("message", (event) => this.take(JSON.parse(event.data)));
    this.socket.addEventListener("close", () => {
      for (const then of this.answers.values()) then({ fault: "the connection was lost: see the goals" });
      this.answers.clear();
      this.say("lost", "No connection: reconnecting. The page can be outdated.");
      window.setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, RETRY.most);
    });
  }

  /** Send a request to the server; ``then`` gets its answer. */
  ask(message, then) {
    if (this.socket.readyState !== WebSocket.OPEN) {
      then({ fault: "there is no connection: try again" });
      return;
    }
    this.asked += 1;
    this.answers.set(this.asked, then);
    this.socket.send(JSON.stringify({ ...message, number: this.asked }));
  }

  take(changes) {
    this.wait = RETRY.first;
    if (changes.answer) {
      const then = this.answers.get(changes.answer.number);
      this.answers.delete(changes.answer.number);
      if (then) then(changes.answer);
      this.player.update();
      return;
    }
    if (changes.whole) this.model.clear();
    this.model.merge(changes, performance.now());
    for (const name of STATE) if (name in changes) this.state[name] = changes[name];
    this.orders.draw(this.state.orders);
    this.operator.draw(this.state);
    if (this.state.core) this.say("live", "Live");
    else this.say("lost", "The core is not running.");
    if (!document.hidden || changes.whole) this.player.update();
  }

  /** Show the state of the connection when it changes, so that a screen reader reads it once. */
  say(name, words) {
    const box = document.getElementById("connection");
    box.className = `connection ${name}`;
    say(box, words);
  }
}

const live = new Live();
document.addEventListener("visibilitychange", () => live.player.update());
