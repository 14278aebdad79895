(() => {
  const { seconds, frames } = JSON.parse(document.getElementById("frames").textContent);
  const [button, slider, clock] = ["play", "time", "clock"].map((id) => document.getElementById(id));
  const parts = [...document.querySelectorAll("#motion [data-p]")].map((part) => [part, part.dataset.p.split(" ").map(Number)]);
  const pause = 1, last = frames.length - 1;
  let time = 0, before = null, playing = false;

  const set = (part, values) => Object.entries(values).forEach(([name, value]) => part.setAttribute(name, value));

  function draw() {
    const at = Math.min(time / seconds, 1) * last, k = Math.min(Math.floor(at), last - 1), share = at - k;
    const place = (point) => [0, 1].map((c) => frames[k][2 * point + c] * (1 - share) + frames[k + 1][2 * point + c] * share);
    for (const [part, points] of parts) {
      const [[x, y], a, b] = points.map(place);
      if (points.length === 1) set(part, { cx: x, cy: y });
      else if (points.length === 2) set(part, { x1: x, y1: y, x2: a[0], y2: a[1] });
      else {
        const angle = (Math.atan2(b[1] - a[1], b[0] - a[0]) * 180) / Math.PI;
        set(part, { transform: `translate(${x} ${y}) rotate(${angle})` });
      }
    }
    slider.value = Math.min(time, seconds);
    clock.textContent = `${Math.min(time, seconds).toFixed(2)} s`;
  }

  function tick(now) {
    if (!playing) return;
    if (before !== null) time += (now - before) / 1000;
    before = now;
    if (time > seconds + pause) time = 0;
    draw();
    requestAnimationFrame(tick);
  }

  function play(on) {
    playing = on;
    before = null;
    button.textContent = on ? "Pause" : "Play";
    if (on) requestAnimationFrame(tick);
  }

  button.addEventListener("click", () => play(!playing));
  slider.addEventListener("input", () => {
    play(false);
    time = Number(slider.value);
    draw();
  });
  document.getElementById("controls").hidden = false;
  draw();
  play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
