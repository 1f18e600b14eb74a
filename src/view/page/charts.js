// A strip for each figure of a layer, over all layers. A click goes to the layer.

const CHARTS = [
  { key: "time", label: "Time", text: duration },
  { key: "travel", label: "Travel", text: length },
];
/** The colours of prints side by side, readable on light and dark. */
const PRINT_COLORS = ["#0b7bd6", "#e07b00", "#1b9e77", "#a8325e", "#8f6cc0", "#8c8c8c"];
/** Half a slider's thumb: the strips line up with the slider below. */
const INSET = 8;

class Charts {
  constructor(app, root) {
    this.app = app;
    this.charts = CHARTS.map((chart) => {
      const canvas = element("canvas", { role: "img", "aria-label": `${chart.label} of each layer; a click goes to the layer` });
      const output = element("output");
      canvas.addEventListener("pointerdown", (event) => this.jump(canvas, event));
      canvas.addEventListener("pointermove", (event) => event.buttons && this.jump(canvas, event));
      root.append(element("div", { class: "chart" }, element("span", {}, chart.label), canvas, output));
      return { ...chart, canvas, output };
    });
  }

  jump(canvas, event) {
    const box = canvas.getBoundingClientRect(), layers = this.app.layers;
    const share = (event.clientX - box.left - INSET) / Math.max(box.width - 2 * INSET, 1);
    this.app.goTo(Math.round(share * (layers - 1)));
  }

  /** Draws anew; `moved`: only the mark of the layer is elsewhere. */
  draw(moved) {
    const { app } = this, style = getComputedStyle(document.documentElement);
    for (const chart of this.charts) {
      const { canvas, key } = chart, ratio = devicePixelRatio || 1;
      const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
      if (!width || !height) continue;
      if (!moved || !chart.picture || chart.picture.width !== width) chart.picture = this.picture(key, width, height, ratio);
      [canvas.width, canvas.height] = [width, height];
      const context = canvas.getContext("2d");
      context.drawImage(chart.picture, 0, 0);
      const x = INSET * ratio + (app.state.layer / Math.max(app.layers - 1, 1)) * (width - 2 * INSET * ratio);
      context.fillStyle = style.getPropertyValue("--ink");
      context.fillRect(x - ratio / 2, 0, ratio, height);
      // Several prints have a table for this.
      chart.output.textContent = app.prints.length > 1 ? "" : chart.text(app.prints[0][key][app.state.layer]);
    }
  }

  /** The curves: filled for one print, lines for several. For each column of pixels the largest of its layers. */
  picture(key, width, height, ratio) {
    const { app } = this, picture = document.createElement("canvas"), context = picture.getContext("2d");
    [picture.width, picture.height] = [width, height];
    const inset = Math.round(INSET * ratio), columns = Math.max(width - 2 * inset, 1), layers = app.layers;
    const curves = app.prints.map((print) => {
      const curve = new Float64Array(columns);
      for (let x = 0; x < columns; x++) {
        // A layer owns the columns nearest to its position on the slider.
        const layerAt = (v) => Math.round((v / columns) * (layers - 1));
        for (let layer = layerAt(x); layer <= Math.max(layerAt(x + 1) - 1, layerAt(x)) && layer < print.layers; layer++) {
          curve[x] = Math.max(curve[x], print[key][layer]);
        }
      }
      return curve;
    });
    const top = curves.reduce((top, curve) => curve.reduce((a, b) => Math.max(a, b), top), 0) || 1;
    curves.forEach((curve, i) => {
      context.beginPath();
      const y = (value) => height - ratio - (value / top) * (height - 3 * ratio);
      curve.forEach((value, x) => context.lineTo(inset + x, y(value)));
      if (curves.length === 1) {
        context.lineTo(inset + columns, y(curve[columns - 1]));
        context.lineTo(inset + columns, height);
        context.lineTo(inset, height);
        context.fillStyle = PRINT_COLORS[0];
        context.globalAlpha = 0.75;
        context.fill();
      } else {
        context.strokeStyle = PRINT_COLORS[i % PRINT_COLORS.length];
        context.lineWidth = 1.5 * ratio;
        context.stroke();
      }
    });
    return picture;
  }
}
