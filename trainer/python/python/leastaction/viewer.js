(() => {
  const { motions, scene, charts, speed, both } = JSON.parse(document.getElementById("data").textContent);
  const [button, slider, clock, speeds, picture, legend, plots] =
    ["play", "time", "clock", "speed", "motion", "legend", "charts"].map((id) => document.getElementById(id));
  const WIDTH = 720, HEIGHT = 380, MARGIN = 28, CHART = 84, LEFT = 64, PAUSE = 1, TAIL = 1;
  const COLOURS = ["#0072b2", "#d55e00"];
  const begin = Math.min(...motions.map((motion) => motion.t[0])), end = Math.max(...motions.map((motion) => motion.t.at(-1)));
  let time = begin, before = null, playing = false;

  const make = (name, attributes, parent) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    set(made, attributes);
    parent.append(made);
    return made;
  };
  const set = (part, values) => Object.entries(values).forEach(([name, value]) => part.setAttribute(name, value));
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const mix = (a, x, b, y) => a.map((of, c) => of * x + b[c] * y);

  /** Row of a table at the time, on a straight line between two samples; outside the motion its first or last row. */
  function at(motion, rows) {
    const { t } = motion;
    let low = 0, high = t.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (t[middle] <= time) low = middle;
      else high = middle;
    }
    const share = Math.min(1, Math.max(0, (time - t[low]) / (t[high] - t[low])));
    return rows[low].map((x, c) => x + share * (rows[high][c] - x));
  }
  const point = (row, k) => row.slice(3 * k, 3 * k + 3);

  /** The mechanism, one group of parts per motion, seen along a direction that dragging turns. */
  function drawing() {
    const svg = make("svg", { id: "scene", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, "stroke-linecap": "round" }, picture);
    const all = motions.flatMap((motion) => motion.points.flatMap((row) => row.map((_, k) => k).filter((k) => k % 3 === 0).map((k) => row.slice(k, k + 3))));
    const ends = [0, 1, 2].map((c) => all.reduce(([least, most], p) => [Math.min(least, p[c]), Math.max(most, p[c])], [Infinity, -Infinity]));
    const middle = ends.map(([least, most]) => (least + most) / 2);
    const radius = all.reduce((most, p) => Math.max(most, Math.hypot(...p.map((x, c) => x - middle[c]))), 1e-6);
    let right = scene.right, up = scene.up;
    // A mechanism that is only seen from one side fills the picture; one that is turned fits into it from every side.
    const extent = (axis) => all.reduce((most, p) => Math.max(most, Math.abs(dot(mix(p, 1, middle, -1), axis))), 1e-6);
    const scale = scene.spatial ? (HEIGHT / 2 - MARGIN) / radius : Math.min((WIDTH / 2 - MARGIN) / extent(right), (HEIGHT / 2 - MARGIN) / extent(up));
    const place = (p) => {
      const from = mix(p, 1, middle, -1);
      return [WIDTH / 2 + scale * dot(from, right), HEIGHT / 2 - scale * dot(from, up)];
    };

    // The second motion, which is laid over the first, is drawn thin and pale enough to show what is below it.
    const groups = motions.map((motion, number) => {
      const group = make("g", { opacity: number ? 0.75 : 1 }, svg), colour = COLOURS[number];
      const tails = scene.tips.length > 12 ? [] : scene.tips.map((tip) => [tip, make("polyline", { fill: "none", stroke: both ? colour : "#cc79a7", "stroke-width": 1.2 }, group)]);
      const kinds = {
        link: () => make("line", { stroke: colour, "stroke-width": number ? 3 : 5 }, group),
        rail: () => make("line", { stroke: "#999", "stroke-width": 2 }, group),
        block: () => make("rect", { x: -14, y: -8, width: 28, height: 16, rx: 2, fill: both ? colour : "#d55e00" }, group),
        pivot: () => make("circle", { r: 4, fill: "#fff", stroke: "#333", "stroke-width": 1.5 }, group),
      };
      return { motion, tails, parts: scene.parts.map(([kind, points]) => [kind, points, kinds[kind]()]) };
    });
    bar(svg, scale);

    function pose({ motion, tails, parts }) {
      const row = at(motion, motion.points), places = (points) => points.map((k) => place(point(row, k)));
      for (const [kind, points, part] of parts) {
        const [[x, y], a, b] = places(points);
        if (kind === "pivot") set(part, { cx: x, cy: y });
        else if (kind === "block") set(part, { transform: `translate(${x} ${y}) rotate(${(Math.atan2(b[1] - a[1], b[0] - a[0]) * 180) / Math.PI})` });
        else set(part, { x1: x, y1: y, x2: a[0], y2: a[1] });
      }
      for (const [tip, line] of tails) {
        const past = motion.points.filter((_, k) => motion.t[k] <= time && motion.t[k] >= time - TAIL);
        line.setAttribute("points", [...past, row].map((of) => place(point(of, tip)).map((x) => x.toFixed(1)).join(",")).join(" "));
      }
    }
    const draw = () => groups.forEach(pose);
    if (scene.spatial) turning(svg, (across, along) => {
      // Turns about the axis that was upright at first, then tilts.
      const sight = cross(right, up), [cos, sin] = [Math.cos(across), Math.sin(across)];
      const spin = (a) => mix(mix(a, cos, cross(scene.up, a), sin), 1, scene.up, dot(scene.up, a) * (1 - cos));
      const tilted = mix(up, Math.cos(along), sight, Math.sin(along));
      [right, up] = dot(tilted, scene.up) < 0.02 ? [spin(right), spin(up)] : [spin(right), spin(tilted)];
      draw();
    }, () => {
      [right, up] = [scene.right, scene.up];
      draw();
    });
    return draw;
  }

  function turning(svg, turn, reset) {
    let held = null;
    svg.style.cursor = "grab";
    svg.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", (event) => {
      if (!held) return;
      turn((held[0] - event.clientX) / 150, (event.clientY - held[1]) / 150);
      held = [event.clientX, event.clientY];
    });
    for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, () => (held = null));
    svg.addEventListener("dblclick", reset);
  }

  /** A round length in the lower left corner. */
  function bar(svg, scale) {
    const lengths = [3, 2, 1, 0, -1, -2, -3, -4].flatMap((power) => [5, 2, 1].map((of) => Number(`${of}e${power}`)));
    const length = lengths.find((of) => of * scale <= 120);
    if (!length) return;
    const y = HEIGHT - 8;
    make("line", { x1: 8, y1: y, x2: 8 + length * scale, y2: y, stroke: "#333", "stroke-width": 1.5 }, svg);
    make("text", { x: 8, y: y - 4, "font-size": 11, fill: "#333" }, svg).textContent = `${length} m`;
  }

  /** A coordinate over time, with a line at the present. */
  function chart(name, i) {
    const svg = make("svg", { viewBox: `0 0 ${WIDTH} ${CHART}`, width: WIDTH, height: CHART, "font-size": 11 }, plots);
    const values = motions.flatMap((motion) => motion.q.map((row) => row[i]));
    const least = values.reduce((a, b) => Math.min(a, b)), most = values.reduce((a, b) => Math.max(a, b)), span = Math.max(most - least, 1e-9);
    const x = (t) => LEFT + ((t - begin) / (end - begin)) * (WIDTH - LEFT - 8), y = (q) => CHART - 12 - ((q - least) / span) * (CHART - 28);
    make("rect", { x: LEFT, y: 12, width: WIDTH - LEFT - 8, height: CHART - 20, fill: "#fafafa" }, svg);
    if (least < 0 && most > 0) make("line", { x1: LEFT, x2: WIDTH - 8, y1: y(0), y2: y(0), stroke: "#ddd" }, svg);
    motions.forEach((motion, number) => {
      const points = motion.t.map((t, k) => `${x(t).toFixed(1)},${y(motion.q[k][i]).toFixed(1)}`).join(" ");
      make("polyline", { points, fill: "none", stroke: COLOURS[number], "stroke-width": number ? 1.3 : 2 }, svg);
    });
    make("text", { x: LEFT + 4, y: 10, fill: "#1b1b1b" }, svg).textContent = name;
    for (const q of most > least ? [least, most] : [least]) make("text", { x: LEFT - 6, y: y(q) + 4, "text-anchor": "end", fill: "#555" }, svg).textContent = Number(q.toPrecision(3));
    const now = make("line", { y1: 12, y2: CHART - 8, stroke: "#333" }, svg);
    return () => set(now, { x1: x(time), x2: x(time) });
  }

  function draw() {
    drawn.forEach((one) => one());
    slider.value = time - begin;
    clock.textContent = `${time.toFixed(2)} s`;
    document.documentElement.dataset.time = time;
  }

  function tick(now) {
    if (!playing) return;
    if (before !== null) time += ((now - before) / 1000) * Number(speeds.value);
    before = now;
    if (time > end + PAUSE * Number(speeds.value)) time = begin;
    const shown = time;
    time = Math.min(time, end);
    draw();
    time = shown;
    requestAnimationFrame(tick);
  }

  function play(on) {
    playing = on;
    before = null;
    if (on && time >= end) time = begin;
    button.textContent = on ? "Pause" : "Play";
    if (on) requestAnimationFrame(tick);
  }

  const drawn = [...(scene ? [drawing()] : []), ...charts.map(chart)];
  slider.max = end - begin;
  for (const of of [...new Set([0.1, 0.25, 0.5, 1, 2, 4, speed])].sort((a, b) => a - b)) speeds.add(new Option(of === 1 ? "real time" : `× ${of}`, of, of === speed, of === speed));
  if (both) motions.forEach(({ label }, number) => {
    const name = document.createElement("span");
    name.style.color = COLOURS[number];
    name.textContent = `— ${label}`;
    legend.append(name);
  });
  button.addEventListener("click", () => play(!playing));
  slider.addEventListener("input", () => {
    play(false);
    time = begin + Number(slider.value);
    draw();
  });
  draw();
  play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
