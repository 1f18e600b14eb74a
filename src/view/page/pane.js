// One print in the window: canvas, caption, nozzle, scale, and what fingers and mouse do.

const NOZZLE = '<svg width="28" height="32" viewBox="0 0 28 32" aria-hidden="true">' +
  '<path d="M4 2h20v12l-8 14h-4L4 14z" fill="currentColor" fill-opacity=".25" stroke="currentColor" stroke-width="1.5"/>' +
  '<circle cx="14" cy="32" r="2.5" fill="currentColor"/></svg>';

class Pane {
  constructor(app, print) {
    Object.assign(this, { app, print, times: null, timesLayer: -1 });
    this.caption = element("div", { class: "caption" });
    this.nozzle = element("div", { class: "nozzle" });
    this.nozzle.innerHTML = NOZZLE;
    this.scale = element("div", { class: "scale", "aria-hidden": "true" });
    this.stage = element("div", { class: "stage" }, this.nozzle, this.scale);
    this.root = element("div", { class: "pane" }, this.caption, this.stage);
    this.usePainter(GlPainter);
    new ResizeObserver(() => {
      const { width, height } = this.size();
      if (width !== this.drawn?.width || height !== this.drawn?.height) app.resized();
    }).observe(this.stage);
  }

  /** Draws with this one if it can be had, and else on a plain canvas. */
  usePainter(Painter) {
    this.canvas?.remove();
    this.canvas = element("canvas", { role: "img", tabindex: "-1" });
    this.stage.prepend(this.canvas);
    try {
      this.painter = new Painter(this.canvas, this.print);
    } catch {
      return this.usePainter(CanvasPainter);
    }
    this.canvas.addEventListener("webglcontextlost", () => {
      this.usePainter(CanvasPainter);
      this.app.judge();
      this.app.setMode(this.app.state.mode);
      this.app.colored();
    });
    this.listen();
  }

  /** From now on it shows this print; `prepared` is what its painter made of it. */
  show(print, prepared = null) {
    Object.assign(this, { print, times: null, timesLayer: -1 });
    if (prepared) this.painter.show(prepared);
    else this.usePainter(GlPainter);
  }

  get solid() {
    return this.painter instanceof GlPainter;
  }

  size() {
    const { clientWidth, clientHeight } = this.stage;
    return { width: Math.max(clientWidth, 1), height: Math.max(clientHeight, 1), ratio: this.solid ? OVERSAMPLING : Math.min(devicePixelRatio || 1, 2) };
  }

  /** Where the nozzle is this many seconds after the layer's start: the current stroke, and how much of it is done. */
  at(layer, seconds) {
    const { print } = this;
    layer = Math.min(layer, print.layers - 1);
    if (layer !== this.timesLayer) [this.times, this.timesLayer] = [strokeTimes(print, layer), layer];
    const count = this.times.length, i = countBelow(this.times, 0, count, seconds - 1e-9);
    if (i >= count) return { layer, stroke: print.first[layer + 1] - 1, part: 1 };
    const before = i > 0 ? this.times[i - 1] : 0, took = this.times[i] - before;
    return { layer, stroke: print.first[layer] + i, part: took > 0 ? Math.max(seconds - before, 0) / took : 1 };
  }

  /** Seconds that the layer takes. */
  layerTime(layer) {
    this.at(layer, 0);
    return this.times.length ? this.times[this.times.length - 1] : 0;
  }

  draw(look, state, camera) {
    const now = this.at(state.layer, state.progress), size = this.size();
    this.drawn = size;
    this.painter.draw(look, now, camera, size);
    this.placeNozzle(now, camera, size);
    this.showScale(look, camera);
  }

  placeNozzle({ stroke, part }, camera, size) {
    const { points, strokes } = this.print;
    this.nozzle.hidden = !strokes;
    if (!strokes) return;
    const p = 3 * Math.max(stroke, 0);
    const point = [0, 1, 2].map((i) => points[p + i] + (points[p + 3 + i] - points[p + i]) * part);
    const [x, y] = camera.project(point, size.width, size.height);
    this.nozzle.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }

  showScale(look, camera) {
    this.scale.hidden = look.mode === "3d";
    if (this.scale.hidden) return;
    const mm = 10 ** Math.floor(Math.log10(100 * camera.mm)), width = mm / camera.mm;
    const times = width < 25 ? 5 : width < 50 ? 2 : 1;
    this.scale.style.width = `${(times * width).toFixed(1)}px`;
    this.scale.textContent = `${+(times * mm).toPrecision(2)} mm`;
  }

  listen() {
    const { canvas, app } = this, down = new Map();
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
    };
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => app.fit());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [x, y] = place(event), lines = event.deltaMode === 1 ? 16 : 1;
      app.zoom(Math.exp(Math.min(Math.max(event.deltaY * lines, -200), 200) * 0.002), x, y);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      down.set(event.pointerId, place(event));
    });
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => down.delete(event.pointerId));
    }
    canvas.addEventListener("pointermove", (event) => {
      const before = down.get(event.pointerId);
      if (!before) return;
      const now = place(event), [dx, dy] = [now[0] - before[0], now[1] - before[1]];
      const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
      down.set(event.pointerId, now);
      if (other) {
        const far = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
        app.drag(dx / 2, dy / 2, canvas.clientHeight, true);
        app.zoom(far(before) / Math.max(far(now), 1), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      } else {
        app.drag(dx, dy, canvas.clientHeight, event.shiftKey || (event.buttons & 6) !== 0);
      }
    });
  }
}
