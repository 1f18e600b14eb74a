// Draws a layer on a plain canvas, where there is no WebGL.

class CanvasPainter {
  constructor(canvas, print) {
    Object.assign(this, { canvas, print, context: canvas.getContext("2d"), values: null });
    gridLines(print);
  }

  setValues(values) {
    this.values = values;
  }

  /** As GlPainter.draw, from above only. */
  draw(look, now, camera, size) {
    const { canvas, context, print } = this, { width, height, ratio } = size;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = look.theme.background;
    context.fillRect(0, 0, width, height);
    const scale = ratio / camera.mm;
    context.setTransform(scale, 0, 0, -scale, (width * ratio) / 2 - camera.middle[0] * scale, (height * ratio) / 2 + camera.middle[1] * scale);
    context.lineCap = context.lineJoin = "round";
    const first = print.first[now.layer], end = Math.min(now.stroke + 1, print.first[now.layer + 1]);
    this.strokes(look, now, first, end, camera.mm, false);
    this.strokes(look, now, first, end, camera.mm, true);
    this.drawMarks(look, now, camera);
  }

  /** Strokes that look the same and follow each other are one path. */
  strokes(look, now, first, end, mm, travels) {
    const { context, print } = this, { role, bead, points } = print;
    let open = null, joined = -1;
    for (let i = first; i < end; i++) {
      if ((role[i] === TRAVEL) !== travels || !((look.roleMask >> role[i]) & 1)) continue;
      const value = look.byValue && !travels ? Math.round(32 * this.values[i]) / 32 : -1;
      const width = travels ? 1.6 * mm : Math.max(0.01 * bead[2 * i], mm), key = `${role[i]} ${width} ${value}`;
      if (key !== open) {
        if (open !== null) context.stroke();
        open = key;
        joined = -1;
        context.beginPath();
        context.lineWidth = width;
        const color = look.colors.slice(3 * role[i], 3 * role[i] + 3).map((c) => Math.round(255 * c));
        context.strokeStyle = value < 0 ? `rgb(${color.join(" ")})` : rampColor(look.rampHex, value);
      }
      const p = 3 * i, part = i === now.stroke ? now.part : 1;
      if (joined !== i) context.moveTo(points[p], points[p + 1]);
      context.lineTo(points[p] + (points[p + 3] - points[p]) * part, points[p + 1] + (points[p + 4] - points[p + 1]) * part);
      joined = i + 1;
    }
    if (open !== null) context.stroke();
  }

  drawMarks(look, now, camera) {
    const { context, print } = this, { mm } = camera, size = 0.45 * markPixels(camera) * mm;
    context.lineWidth = mm;
    context.strokeStyle = look.theme.background;
    for (let i = print.firstMark[now.layer]; i < print.firstMark[now.layer + 1] && print.markStroke[i] <= now.stroke; i++) {
      const kind = print.markKind[i], x = print.markPoints[3 * i];
      const y = print.markPoints[3 * i + 1] + [size, -size, 0][kind];
      if (!((look.markMask >> kind) & 1)) continue;
      context.beginPath();
      if (kind === 2) for (const [dx, dy] of [[0, 1], [1, 0], [0, -1], [-1, 0]]) context.lineTo(x + dx * size, y + dy * size);
      else for (const [dx, dy] of [[-1, 0.7], [1, 0.7], [0, -1]]) context.lineTo(x + dx * size, y + (kind ? -dy : dy) * size);
      context.closePath();
      context.fillStyle = [look.theme.retraction, look.theme.unretraction, look.theme.seam][kind];
      context.fill();
      context.stroke();
    }
  }
}
