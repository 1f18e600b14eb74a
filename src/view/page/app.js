// The page's state, and what follows from a change of it.

class App {
  constructor(data, prints) {
    Object.assign(this, { data, prints, range: null, frame: 0, moved: false, touched: false });
    this.layers = Math.max(...prints.map((print) => print.layers));
    const several = prints.length > 1;
    this.state = {
      mode: "2d", layer: 0, progress: Infinity, color: "role", playing: false, theme: null,
      // In space travel and marks hide more than they tell.
      hiddenIn: { "2d": new Set(several ? ["mark-0", "mark-1", "mark-2"] : ["mark-1"]), "3d": new Set(["role-13", "mark-0", "mark-1", "mark-2"]) },
    };
    const bounds = [0, 1, 2, 3].map((i) => (i < 2 ? Math.min : Math.max)(...prints.map((print) => print.bounds[i])));
    this.cameras = { "2d": new FlatCamera(bounds), "3d": new TurnCamera(prints.flatMap(outlineOf)) };
    this.panes = prints.map((print) => new Pane(this, print));
    this.layOut();
    this.charts = new Charts(this, find("charts"));
    this.legend = new Legend(this, find("legend"));
    this.judge();
    this.begin(several);
  }

  /** Gives every print its place. */
  layOut() {
    const { length } = this.prints;
    find("panes").style.setProperty("--columns", Math.min(length, length === 4 ? 2 : 3));
    find("panes").style.setProperty("--rows", Math.min(length, 2));
    find("panes").replaceChildren(...this.panes.map((pane) => pane.root));
    for (const { caption } of this.panes) caption.hidden = length === 1;
    find("figures").hidden = length > 1;
    find("layer").max = this.layers;
  }

  /** Whether 3D is to be had. */
  judge() {
    this.solid = this.panes.every((pane) => pane.solid);
    find("view-3d").disabled = !this.solid;
    if (!this.solid) find("view-3d").title = "This browser has no WebGL 2: layers only";
  }

  /** The first view: several prints at the layer where they differ most, one print as a whole if there is any. */
  begin(several) {
    const query = new URLSearchParams(location.hash.slice(1));
    const spread = (layer) => {
      const travels = this.prints.map((print) => print.travel[layer] ?? 0);
      return Math.max(...travels) - Math.min(...travels);
    };
    let busiest = 0;
    for (let layer = 1; layer < this.layers; layer++) if (spread(layer) > spread(busiest)) busiest = layer;
    this.state.theme = query.get("theme") || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    document.documentElement.dataset.theme = this.state.theme;
    if (query.get("color") in COLORINGS) find("color").value = this.state.color = query.get("color");
    // Where nothing is extruded, travel is all there is to see.
    const solid = !several && this.lengths().some((length, role) => role < TRAVEL && length > 0);
    this.setMode(query.get("view") || (solid ? "3d" : "2d"));
    this.goTo(query.has("layer") ? query.get("layer") - 1 : several ? busiest : this.layers - 1);
    if (query.has("progress")) this.setProgress(this.longest() * query.get("progress"));
    this.colored();
  }

  theme() {
    return this.data.themes[this.state.theme];
  }

  camera() {
    return this.cameras[this.state.mode];
  }

  /** What is not ticked in the legend. */
  hidden() {
    return this.state.hiddenIn[this.state.mode];
  }

  /** Length of each role over all prints, travel last. */
  lengths() {
    this.lengthCache ??= this.prints.reduce((sums, print) => {
      print.lengths ??= roleLengths(print);
      return sums.map((sum, role) => sum + print.lengths[role]);
    }, new Float64Array(JUMP));
    return this.lengthCache;
  }

  markCounts() {
    return this.prints.reduce((sums, print) => {
      print.markCounts ??= markCounts(print);
      return sums.map((sum, kind) => sum + print.markCounts[kind]);
    }, [0, 0, 0]);
  }

  longest() {
    return Math.max(...this.panes.map((pane) => pane.layerTime(this.state.layer)));
  }

  setMode(mode) {
    this.state.mode = mode === "3d" && this.solid ? "3d" : "2d";
    for (const name of ["2d", "3d"]) find(`view-${name}`).setAttribute("aria-pressed", name === this.state.mode);
    this.legend.draw();
    this.schedule();
  }

  goTo(layer, progress = Infinity) {
    const whole = Math.round(+layer) || 0;
    this.state.layer = Math.min(Math.max(whole, 0), this.layers - 1);
    this.setProgress(progress);
  }

  setProgress(seconds) {
    this.state.progress = Math.min(Math.max(seconds, 0), this.longest());
    this.moved = true;
    this.schedule();
  }

  /** To the end of a stroke so many strokes from here, of the first print, also into the layers beside. */
  step(strokes) {
    const pane = this.panes[0], { layer, stroke, part } = pane.at(this.state.layer, this.state.progress);
    const wanted = stroke + strokes + (strokes < 0 && part < 1 ? 1 : 0), { first } = pane.print;
    if (wanted < first[layer]) return layer > 0 ? this.goTo(layer - 1) : this.setProgress(0);
    if (wanted >= first[layer + 1]) return layer + 1 < this.layers ? this.goTo(layer + 1, 0) : this.setProgress(Infinity);
    this.setProgress(pane.times[wanted - first[layer]]);
  }

  toggle(key) {
    const hidden = this.hidden();
    if (!hidden.delete(key)) hidden.add(key);
    this.legend.draw();
    this.schedule();
  }

  toggleTheme() {
    this.state.theme = this.state.theme === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = this.state.theme;
    this.legend.draw();
    this.resized();
  }

  setColor(color) {
    this.state.color = color;
    this.colored();
  }

  /** Gives the painters their values. */
  colored() {
    const { color } = this.state;
    this.range = null;
    if (COLORINGS[color]) {
      const all = this.prints.map((print) => valuesOf(print, color));
      const low = Math.min(...all.map((v) => v.low)), high = Math.max(...all.map((v) => v.high));
      if (low <= high) this.range = { low, high };
      this.panes.forEach((pane, i) => pane.painter.setValues(scaleValues(all[i].values, low, high)));
    }
    this.legend.draw();
    this.schedule();
  }

  fit() {
    this.fitted = this.touched = false;
    this.schedule();
  }

  zoom(factor, x = 0, y = 0) {
    this.touched = true;
    this.camera().zoom(factor, x, y);
    this.schedule();
  }

  drag(dx, dy, height, move) {
    const camera = this.camera();
    this.touched = true;
    if (camera instanceof TurnCamera && !move) camera.turn(dx, dy);
    else camera.drag(dx, dy, height);
    this.schedule();
  }

  /** A view that nobody has chosen stays as large as the window lets it be. */
  resized() {
    this.moved = false;
    if (!this.touched) this.fitted = false;
    this.schedule();
  }

  play(on = !this.state.playing) {
    const { state } = this;
    state.playing = on;
    const button = find("play");
    button.textContent = on ? "⏸" : "▶";
    button.setAttribute("aria-pressed", on);
    button.setAttribute("aria-label", on ? "Pause" : "Play");
    if (!on) return;
    if (state.progress >= this.longest()) state.layer + 1 < this.layers && state.mode === "3d" ? this.goTo(state.layer + 1, 0) : this.setProgress(0);
    let before = performance.now();
    const tick = (now) => {
      if (!state.playing) return;
      const seconds = (Math.max(now - before, 0) / 1000) * +find("rate").value;
      before = now;
      if (state.progress < this.longest()) this.setProgress(state.progress + seconds);
      else if (state.layer + 1 < this.layers) this.goTo(state.layer + 1, 0);
      else return this.play(false);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  schedule() {
    this.frame ||= requestAnimationFrame(() => this.render());
  }

  /** All that is seen, from the state. */
  render() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { state, prints } = this;
    const size = this.panes[0].size();
    if (!this.fitted) {
      for (const camera of Object.values(this.cameras)) camera.fit(size.width, size.height);
      this.fitted = true;
    }
    const look = this.look();
    for (const pane of this.panes) pane.draw(look, state, this.camera());
    this.showText();
    this.charts.draw(this.moved);
    this.moved = true;
    if (prints.length > 1) drawTable(find("table"), prints, Math.min(state.layer, ...prints.map((p) => p.layers - 1)));
    else drawFigures(find("figures"), prints[0], state.layer);
  }

  look() {
    const { state, data } = this, theme = this.theme(), hidden = this.hidden();
    const mask = (kind, count) => [...Array(count).keys()].reduce((m, i) => m | (hidden.has(`${kind}-${i}`) ? 0 : 1 << i), 0);
    const colors = data.roles.map((role) => role.color);
    colors[TRAVEL] = theme.travel;
    return {
      mode: state.mode, theme, roleMask: mask("role", TRAVEL + 1), markMask: mask("mark", 3), byValue: this.range !== null,
      colors: new Float32Array(colors.flatMap(rgb)), ramp: new Float32Array(data.ramp.flatMap(rgb)), rampHex: data.ramp,
      markColors: new Float32Array([theme.retraction, theme.unretraction, theme.seam].flatMap(rgb)),
    };
  }

  showText() {
    const { state, prints, panes, layers } = this, layer = find("layer"), slider = find("progress"), longest = this.longest();
    const z = prints[0].z[Math.min(state.layer, prints[0].layers - 1)];
    layer.value = state.layer + 1;
    slider.max = longest || 1;
    slider.value = longest ? state.progress : 1;
    find("layer-text").textContent = `${state.layer + 1} / ${layers} · ${fixed(z, 2)} mm`;
    find("progress-text").textContent = `${duration(state.progress)} / ${duration(longest)}`;
    layer.setAttribute("aria-valuetext", `layer ${state.layer + 1} of ${layers}, at ${fixed(z, 2)} mm`);
    slider.setAttribute("aria-valuetext", `${duration(state.progress)} of ${duration(longest)}`);
    for (const { print, canvas, caption } of panes) {
      const i = Math.min(state.layer, print.layers - 1);
      const gap = gapOf(print.link[i], print.bound[i]);
      const text = `${length(print.travel[i])} travel, ${duration(print.time[i])}${gap === null ? "" : `, gap ${percent(gap)}`}`;
      caption.replaceChildren(element("b", {}, print.name), text);
      canvas.setAttribute("aria-label", `${print.name}, layer ${i + 1}: ${length(print.print[i])} printed, ${text}`);
    }
  }
}
