// Starts the page.

function listen(app) {
  find("view-2d").addEventListener("click", () => app.setMode("2d"));
  find("view-3d").addEventListener("click", () => app.setMode("3d"));
  find("fit").addEventListener("click", () => app.fit());
  find("theme").addEventListener("click", () => app.toggleTheme());
  find("help").addEventListener("click", () => find("keys").showModal());
  find("color").addEventListener("change", (event) => app.setColor(event.target.value));
  find("layer").addEventListener("input", (event) => app.goTo(event.target.value - 1));
  find("progress").addEventListener("input", (event) => app.setProgress(+event.target.value));
  find("play").addEventListener("click", () => app.play());
  find("back").addEventListener("click", () => app.step(-1));
  find("forward").addEventListener("click", () => app.step(1));
  const keys = {
    ArrowUp: (e) => app.goTo(app.state.layer + (e.shiftKey ? 10 : 1)),
    ArrowDown: (e) => app.goTo(app.state.layer - (e.shiftKey ? 10 : 1)),
    ArrowRight: (e) => app.step(e.shiftKey ? 50 : 1),
    ArrowLeft: (e) => app.step(e.shiftKey ? -50 : -1),
    PageUp: () => app.goTo(app.state.layer + 10),
    PageDown: () => app.goTo(app.state.layer - 10),
    Home: () => app.goTo(0),
    End: () => app.goTo(app.layers - 1),
    " ": () => app.play(),
    "+": () => app.zoom(0.8),
    "-": () => app.zoom(1.25),
    0: () => app.fit(),
    2: () => app.setMode("2d"),
    3: () => app.setMode("3d"),
    t: () => app.toggle(`role-${TRAVEL}`),
    "?": () => find("keys").showModal(),
  };
  document.addEventListener("keydown", (event) => {
    // A list, a button and a tick box have keys of their own.
    const own = event.target.closest?.("select, dialog") || (event.key === " " && event.target.closest?.("button, input[type=checkbox]"));
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (own || event.ctrlKey || event.metaKey || event.altKey || !keys[key]) return;
    event.preventDefault();
    keys[key](event);
  });
}

function notify(text) {
  find("notice").hidden = false;
  find("notice").append(element("div", {}, text));
}

async function start() {
  if (typeof DecompressionStream === "undefined") throw new Error("this browser is too old; it cannot unpack the print");
  const data = JSON.parse(find("data").textContent);
  const prints = [];
  for (const [i, info] of data.prints.entries()) {
    const packed = find(`print-${i}`);
    prints.push(unpack(await inflate(fromBase64(packed.textContent.trim())), info));
    packed.remove();
    info.notes.forEach(notify);
  }
  const app = new App(data, prints);
  listen(app);
  app.render();
  // For whoever looks from the console.
  window.pathwright = app;
}

start().catch((error) => notify(`The print cannot be shown: ${error.message}.`));
