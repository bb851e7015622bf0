/* Curves that a reader can zoom. Every figure with data is drawn anew from it; all with the same horizontal axis share one view. */
(() => {
  const figures = [];
  const view = new Map();
  const space = document.querySelector("svg").namespaceURI;
  const make = (name, attributes, text) => {
    const element = document.createElementNS(space, name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  /* At least two: one alone says no scale. */
  const ticks = (low, high, most) => {
    const found = [0, 1, 2, 3, 4].map((more) => some(low, high, most + more));
    return found.find((t) => t.all.length > 1) || found[0];
  };
  const some = (low, high, most) => {
    const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw) || raw;
    const all = [];
    for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) all.push(k * step);
    return { all, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
  };
  const label = (value, digits) => value.toFixed(digits).replace("-", "\u2212");
  /* First index whose x is not below `value`. */
  const at = (x, value) => {
    let low = 0, high = x.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (x[middle] < value) low = middle + 1; else high = middle;
    }
    return low;
  };
  const whole = (data) => {
    let range = [Infinity, -Infinity];
    for (const panel of data.panels) for (const layer of panel.layers) for (const [x] of layer.pieces)
      range = [Math.min(range[0], x[0]), Math.max(range[1], x[x.length - 1])];
    return range;
  };
  const draw = (figure) => {
    const { svg, data } = figure, left = 62, right = 948;
    const [from, to] = view.get(data.x) || figure.whole;
    const X = (t) => left + ((t - from) / (to - from)) * (right - left);
    figure.scale = { from, to, left, right };
    svg.replaceChildren();
    svg.append(make("text", { class: "ft", x: 2, y: 15 }, data.title));
    let along = left;
    for (const layer of data.panels[0].layers) {
      svg.append(make("line", { class: `c ${layer.ink}`, x1: along, x2: along + 18, y1: 30, y2: 30 }));
      svg.append(make("text", { class: "v", x: along + 23, y: 34 }, layer.name));
      along += 40 + 7.2 * layer.name.length;
    }
    let top = 44;
    figure.panels = [];
    data.panels.forEach((panel, index) => {
      const bottom = top + panel.height;
      let low = Infinity, high = -Infinity;
      const shown = panel.layers.map((layer) => layer.pieces.map(([x, y]) => {
        const first = at(x, from), last = at(x, to);
        for (let i = first; i < last; i++) {
          if (y[i] < low) low = y[i];
          if (y[i] > high) high = y[i];
        }
        return [first, last];
      }));
      if (!(high > low)) { low = (Number.isFinite(low) ? low : 0) - 1; high = low + 2; }
      const pad = 0.06 * (high - low);
      low -= pad; high += pad;
      const Y = (v) => bottom - ((v - low) / (high - low)) * (bottom - top);
      const vertical = ticks(low, high, panel.height / 36), horizontal = ticks(from, to, 9);
      for (const v of vertical.all) {
        svg.append(make("line", { class: Math.abs(v) < 1e-12 ? "z" : "g", x1: left, x2: right, y1: Y(v), y2: Y(v) }));
        svg.append(make("text", { x: left - 6, y: Y(v) + 4, "text-anchor": "end" }, label(v, vertical.digits)));
      }
      for (const t of horizontal.all) {
        svg.append(make("line", { class: "g", x1: X(t), x2: X(t), y1: top, y2: bottom }));
        if (index === data.panels.length - 1)
          svg.append(make("text", { x: X(t), y: bottom + 16, "text-anchor": "middle" }, label(t, horizontal.digits)));
      }
      panel.layers.forEach((layer, l) => {
        let path = "";
        layer.pieces.forEach(([x, y], p) => {
          const [first, last] = shown[l][p];
          for (let i = first; i < last; i++) path += `${i === first ? "M" : "L"}${X(x[i]).toFixed(1)} ${Y(y[i]).toFixed(1)}`;
        });
        svg.append(make("path", { class: `c ${layer.ink}`, d: path }));
      });
      svg.append(make("text", { class: "l", transform: `translate(11 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, panel.label));
      svg.append(make("line", { class: "a", x1: left, x2: right, y1: bottom, y2: bottom }));
      figure.panels.push({ panel, top, bottom });
      top = bottom + 14;
    });
    svg.append(make("text", { class: "l", x: (left + right) / 2, y: top + 20, "text-anchor": "middle" }, data.x));
    figure.mark = make("rect", { class: "zoom", y: 44, height: Math.max(0, top - 58), width: 0 });
    figure.line = make("line", { class: "m", x1: -9, x2: -9, y1: 44, y2: top - 14 });
    figure.said = make("text", { class: "v", x: right, y: 15, "text-anchor": "end" }, "");
    svg.append(figure.mark, figure.line, figure.said);
    svg.setAttribute("viewBox", `0 0 960 ${top + 26}`);
  };
  const redraw = (x) => figures.filter((f) => f.data.x === x).forEach(draw);
  const time = (figure, event) => {
    const box = figure.svg.getBoundingClientRect(), { from, to, left, right } = figure.scale;
    const part = (((event.clientX - box.left) * 960) / box.width - left) / (right - left);
    return from + Math.min(1, Math.max(0, part)) * (to - from);
  };
  const pixel = (figure, t) => {
    const { from, to, left, right } = figure.scale;
    return left + ((t - from) / (to - from)) * (right - left);
  };
  const hover = (figure, t) => {
    const [across, unit] = figure.data.x.split(" / ");
    const said = [`${across} ${t.toPrecision(4)} ${unit || ""}`];
    for (const { panel } of figure.panels) {
      const [what, unit] = panel.label.split(" / "), values = [];
      for (const layer of panel.layers) {
        const piece = layer.pieces.find(([x]) => x[0] <= t && t <= x[x.length - 1]);
        if (piece) values.push(`${layer.name} ${piece[1][at(piece[0], t)].toPrecision(3)}`);
      }
      if (values.length) said.push(`${what}: ${values.join(", ")} ${unit || ""}`);
    }
    figure.line.setAttribute("x1", pixel(figure, t));
    figure.line.setAttribute("x2", pixel(figure, t));
    figure.said.textContent = said.join(" · ");
  };
  document.querySelectorAll("script.curves").forEach((source) => {
    const svg = source.parentElement.querySelector("svg"), data = JSON.parse(source.textContent);
    const figure = { svg, data, whole: whole(data) };
    if (!(figure.whole[1] > figure.whole[0])) return;
    figures.push(figure);
    draw(figure);
    let start = null;
    svg.classList.add("live");
    svg.addEventListener("pointerdown", (event) => {
      start = { t: time(figure, event), pan: event.shiftKey, view: [figure.scale.from, figure.scale.to] };
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", (event) => {
      const now = time(figure, event);
      if (start && start.pan) {
        const shift = start.t - now, [from, to] = [figure.scale.from, figure.scale.to];
        view.set(data.x, [from + shift, to + shift]);
        redraw(data.x);
      } else if (start) {
        const [a, b] = [pixel(figure, Math.min(start.t, now)), pixel(figure, Math.max(start.t, now))];
        figure.mark.setAttribute("x", a);
        figure.mark.setAttribute("width", b - a);
      } else figures.filter((f) => f.data.x === data.x).forEach((f) => hover(f, now));
    });
    svg.addEventListener("pointerup", (event) => {
      const now = time(figure, event), begun = start;
      start = null;
      if (!begun || begun.pan) return;
      const [from, to] = [Math.min(begun.t, now), Math.max(begun.t, now)];
      if (to - from > 0.005 * (begun.view[1] - begun.view[0])) {
        view.set(data.x, [from, to]);
        redraw(data.x);
      }
    });
    svg.addEventListener("dblclick", () => { view.delete(data.x); redraw(data.x); });
  });
})();
