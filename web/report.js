"use strict";
// The report of a finished run, with its data in the page.

const model = new RunModel();
model.merge(JSON.parse(document.getElementById("run").textContent));
const player = new Player(model);

/** Go to the moment in the address (#t=12.5). */
function toAddress() {
  const found = /^#t=([0-9.]+)$/.exec(window.location.hash);
  if (found) player.seek(Number(found[1]));
}
window.addEventListener("hashchange", toAddress);
toAddress();
