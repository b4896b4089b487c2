"use strict";
// The live page: a run that goes on. What is new comes over a WebSocket; a connection that was lost is made again.

const RETRY = { first: 500, most: 5000 }; // ms

class Live {
  constructor() {
    this.model = new RunModel();
    this.player = new Player(this.model);
    this.wait = RETRY.first;
    this.connect();
  }

  connect() {
    const secure = window.location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${secure}//${window.location.host}/run`);
    this.socket.addEventListener("message", (event) => this.take(JSON.parse(event.data)));
    this.socket.addEventListener("close", () => {
      this.say("lost", "No connection: trying again. What is shown may be old.");
      window.setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, RETRY.most);
    });
  }

  take(changes) {
    this.wait = RETRY.first;
    if (changes.whole) this.model.clear();
    this.model.merge(changes);
    if (changes.core) this.say("live", "Live");
    else this.say("lost", "The core is not there: nothing is planned.");
    if (!document.hidden || changes.whole) this.player.update();
  }

  /** Say how the connection is, once when it changes, so that a screen reader says it once. */
  say(name, words) {
    const box = document.getElementById("connection");
    if (box.textContent === words) return;
    box.className = `connection ${name}`;
    box.textContent = words;
  }
}

const live = new Live();
document.addEventListener("visibilitychange", () => live.player.update());
