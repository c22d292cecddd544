// Draws each plot when it comes into sight, and marks the time of the playback in all of them.
"use strict";
const PLOTS = JSON.parse(document.getElementById("plots").textContent);
const MARKS = JSON.parse(document.getElementById("marks").textContent).map((time) => ({
  type: "line", x0: time, x1: time, yref: "paper", y0: 0, y1: 1, line: {color: "#5b6670", width: 1, dash: "dot"},
}));
const BANDS = JSON.parse(document.getElementById("bands").textContent).map(({begin, end, color, fault}) => ({
  type: "rect", x0: begin, x1: end, yref: "paper", layer: "below", line: {width: 0}, fillcolor: color,
  ...(fault ? {y0: 0, y1: 1, opacity: 0.12} : {y0: 1.01, y1: 1.04}),
}));
const LAYOUT = {
  height: 270, margin: {l: 60, r: 12, t: 14, b: 40}, hovermode: "x unified", paper_bgcolor: "#fff", plot_bgcolor: "#fff",
  font: {size: 12, color: "#1d2329", family: "system-ui, sans-serif"}, legend: {font: {size: 11}},
};
const AXIS = {gridcolor: "#dfe3e7", zerolinecolor: "#b9c2ca", linecolor: "#b9c2ca", exponentformat: "power", automargin: true};
const drawn = [];

function draw(place) {
  const figure = PLOTS[Number(place.dataset.plot)];
  const layout = {
    ...LAYOUT, ...figure.layout, shapes: [...BANDS, ...MARKS, ...(figure.layout.shapes || [])],
    xaxis: {...AXIS, title: {text: "time [s]"}, ...figure.layout.xaxis}, yaxis: {...AXIS, ...figure.layout.yaxis},
  };
  Plotly.newPlot(place, figure.data, layout, {responsive: true, displaylogo: false}).then(() => {
    if (!document.getElementById("view")) return;
    const cursor = document.createElement("div");
    cursor.className = "cursor";
    place.append(cursor);
    drawn.push({place, cursor});
    place.on("plotly_click", (event) => document.dispatchEvent(new CustomEvent("seek", {detail: event.points[0].x})));
  });
}

function markTime(time) {
  for (const {place, cursor} of drawn) {
    const axis = place._fullLayout.xaxis;
    const inside = axis.range[0] <= time && time <= axis.range[1];
    cursor.style.display = inside ? "block" : "none";
    if (inside) cursor.style.left = `${axis._offset + axis.l2p(time)}px`;
  }
}

const waiting = new Set(document.querySelectorAll(".plot"));

function drawOnce(place) {
  if (!waiting.delete(place)) return;
  sight.unobserve(place);
  draw(place);
}

const sight = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting) drawOnce(entry.target);
}, {rootMargin: "600px"});
waiting.forEach((place) => sight.observe(place));
// What was never in sight is printed all the same.
window.addEventListener("beforeprint", () => [...waiting].forEach(drawOnce));
