// What the colours mean; a tick hides and shows.

class Legend {
  constructor(app, root) {
    Object.assign(this, { app, root });
  }

  /** Lists what the prints hold, or above it the scale of what is coloured by. */
  draw() {
    const { app, root } = this, { state, data } = app;
    const theme = app.theme(), coloring = COLORINGS[state.color], parts = [];
    if (coloring && app.range) {
      const text = (value) => `${fixed(value, coloring.digits)} ${coloring.unit}`.trim();
      const [low, high] = state.color === "order" ? ["first", "last"] : [text(app.range.low), text(app.range.high)];
      parts.push(
        element("h2", {}, coloring.label),
        element("div", { class: "ramp", style: `background: linear-gradient(90deg, ${data.ramp.join(", ")})` }),
        element("div", { class: "ends" }, element("span", {}, low), element("span", {}, high)),
      );
    }
    const list = element("ul");
    const item = (key, label, swatch, share, thin = false) => {
      const box = element("input", { type: "checkbox", "data-key": key, onchange: () => app.toggle(key) });
      box.checked = !app.hidden().has(key);
      const sample = typeof swatch === "string"
        ? element("span", { class: thin ? "swatch thin" : "swatch", style: `background: ${swatch}` })
        : swatch;
      list.append(element("li", {}, element("label", {}, box, sample, label, element("span", { class: "share" }, share))));
    };
    const lengths = app.lengths(), total = lengths.reduce((sum, length) => sum + length, 0) || 1;
    data.roles.forEach(({ label, color }, i) => {
      if (lengths[i] > 0) item(`role-${i}`, label, coloring ? "transparent" : color, percent(lengths[i] / total));
    });
    item(`role-${TRAVEL}`, "Travel", theme.travel, percent(lengths[TRAVEL] / total), true);
    const counts = app.markCounts();
    [["Retraction", "▼", theme.retraction], ["Unretraction", "▲", theme.unretraction], ["Seam", "◆", theme.seam]]
      .forEach(([label, sign, color], i) => {
        const swatch = element("span", { style: `color: ${color}; width: 18px; text-align: center`, "aria-hidden": "true" }, sign);
        if (counts[i]) item(`mark-${i}`, label, swatch, app.prints.length > 1 ? "" : String(counts[i]));
      });
    parts.push(element("h2", {}, "Share of the distance"), list);
    root.replaceChildren(...parts);
  }
}
