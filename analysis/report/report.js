"use strict";
// Draws every chart of the page with Chart.js, then says on the root element how many came out:
// data-charts-drawn, data-charts-expected, and data-error if anything went wrong.
(() => {
  const root = document.documentElement;
  const problem = (message) => { root.dataset.error = ((root.dataset.error || "") + " " + message).trim(); };
  window.addEventListener("error", (event) => problem(event.message));

  // Okabe & Ito (2008): told apart by colour-blind readers; each with its own marker, for print without colour.
  const lightColours = ["#0072b2", "#d55e00", "#009e73", "#b0478a", "#b97f00", "#3a3f44"];
  const darkColours = ["#56b4e9", "#ff8c42", "#2fcf9f", "#e29cc9", "#f0c040", "#cfd6db"];
  const markers = ["circle", "rect", "triangle", "rectRot", "crossRot", "star"];

  const raised = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
  const style = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const isDark = () => window.matchMedia("(prefers-color-scheme: dark)").matches && !window.matchMedia("print").matches;
  const withAlpha = (hex, alpha) => hex + Math.round(alpha * 255).toString(16).padStart(2, "0");

  // How far, in pixels, the points between two fractions of the width stay away from a height.
  const clearance = (chart, height, from, to) => {
    const { chartArea: area, scales } = chart;
    let nearest = Infinity;
    for (const set of chart.data.datasets)
      for (const point of set.data) {
        const x = (scales.x.getPixelForValue(point.x) - area.left) / area.width;
        if (point.y === null || x < from || x > to) continue;
        nearest = Math.min(nearest, Math.abs(scales.y.getPixelForValue(point.y) - height + 10));
      }
    return nearest;
  };

  const shadeWindows = (chart, options) => {
    const { ctx, chartArea: area, scales } = chart;
    ctx.fillStyle = withAlpha(options.shade, 0.16);
    for (const window of options.windows) {
      const left = scales.x.getPixelForValue(window.from), right = scales.x.getPixelForValue(window.to);
      ctx.fillRect(left, area.top, Math.max(2, right - left), area.bottom - area.top);
    }
  };

  // Over the points, with a rim of the paper's colour: legible wherever it falls.
  const write = (ctx, text, x, y, colour, paper) => {
    ctx.lineWidth = 4;
    ctx.lineJoin = "round";
    ctx.strokeStyle = paper;
    ctx.strokeText(text, x, y);
    ctx.fillStyle = colour;
    ctx.fillText(text, x, y);
  };

  // The same words at the top of every stretch, where they fit; the name of a band beside it.
  const writeNames = (chart, options) => {
    const { ctx, chartArea: area, scales } = chart;
    let free = area.left;
    ctx.font = "12px " + getComputedStyle(document.body).fontFamily;
    ctx.textAlign = "left";
    for (const window of options.windows) {
      const width = ctx.measureText(window.name).width;
      const at = Math.max(scales.x.getPixelForValue(window.from) + 6, free);
      if (at + width > area.right) continue;
      write(ctx, window.name, at, area.top + 14, options.shade, options.paper);
      free = at + width + 12;
    }
    for (const band of options.bands) {
      const middle = scales.y.getPixelForValue(band.value);
      const atRight = clearance(chart, middle, 0.7, 1) >= clearance(chart, middle, 0, 0.3);
      ctx.textAlign = atRight ? "right" : "left";
      write(ctx, band.name, atRight ? area.right - 8 : area.left + 8, middle - 6, options.ink, options.paper);
    }
  };

  // Chart.js has neither error bars nor reference bands nor shaded stretches.
  const bandsAndErrors = {
    id: "bandsAndErrors",
    beforeDatasetsDraw(chart, _args, options) {
      const { ctx, chartArea: area, scales } = chart;
      ctx.save();
      ctx.beginPath();
      ctx.rect(area.left, area.top, area.width, area.height);
      ctx.clip();
      shadeWindows(chart, options);
      for (const band of options.bands) {
        const middle = scales.y.getPixelForValue(band.value);
        if (band.half > 0) {
          const top = scales.y.getPixelForValue(band.value + band.half);
          const bottom = scales.y.getPixelForValue(band.value - band.half);
          ctx.fillStyle = withAlpha(options.ink, 0.1);
          ctx.fillRect(area.left, top, area.width, bottom - top);
        }
        ctx.strokeStyle = withAlpha(options.ink, 0.65);
        ctx.lineWidth = 1.5;
        ctx.setLineDash([6, 4]);
        ctx.beginPath();
        ctx.moveTo(area.left, middle);
        ctx.lineTo(area.right, middle);
        ctx.stroke();
        ctx.setLineDash([]);
      }
      ctx.restore();
    },
    afterDatasetsDraw(chart, _args, options) {
      const { ctx, chartArea: area, scales } = chart;
      ctx.save();
      ctx.beginPath();
      ctx.rect(area.left, area.top, area.width, area.height);
      ctx.clip();
      chart.data.datasets.forEach((set, index) => {
        if (!chart.isDatasetVisible(index)) return;
        ctx.strokeStyle = set.borderColor;
        ctx.lineWidth = 1.5;
        ctx.beginPath();
        for (const point of set.data) {
          if (!(point.e > 0) || point.y === null) continue;
          const x = scales.x.getPixelForValue(point.x);
          const high = scales.y.getPixelForValue(point.y + point.e);
          const below = point.y - point.e;
          const low = scales.y.type === "logarithmic" && below <= 0 ? area.bottom : scales.y.getPixelForValue(below);
          ctx.moveTo(x, high);
          ctx.lineTo(x, low);
          for (const end of [high, low]) {
            ctx.moveTo(x - 4, end);
            ctx.lineTo(x + 4, end);
          }
        }
        ctx.stroke();
      });
      writeNames(chart, options);
      ctx.restore();
    },
  };

  // The values an axis has to show, error bars and references included.
  const extent = (data, axis) => {
    let low = Infinity, high = -Infinity;
    const include = (value) => { low = Math.min(low, value); high = Math.max(high, value); };
    for (const series of data.series)
      for (const point of series.data) {
        if (point[axis] === null) continue;
        include(point[axis]);
        if (axis === "y" && point.e > 0) { include(point.y + point.e); include(point.y - point.e); }
      }
    if (axis === "y") for (const band of data.bands) { include(band.value + band.half); include(band.value - band.half); }
    return { low, high };
  };

  const scale = (data, axis, colours) => {
    const logarithmic = data[axis].log;
    const { low, high } = extent(data, axis);
    const room = high > low ? 0.04 * (high - low) : 0.1 * Math.abs(high) || 1;
    const marked = data.series.some((series) => series.points);
    const result = {
      type: logarithmic ? "logarithmic" : "linear",
      title: { display: true, text: data[axis].title, color: colours.soft },
      grid: { color: colours.line, borderColor: colours.soft },
      ticks: { color: colours.soft, maxRotation: 0, includeBounds: false },
    };
    if (!Number.isFinite(low)) return result;
    if (!logarithmic) {
      result.suggestedMin = axis === "x" && !marked ? low : low - room;
      result.suggestedMax = axis === "x" && !marked ? high : high + room;
      if (axis === "y" && data.windows.length > 0) result.suggestedMax = high + 0.14 * (high - low);  // the names of stretches stand there
      if (low >= 0 && low - room < 0) result.suggestedMin = 0;
    } else {
      const decade = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
      const decades = Math.log10(high / Math.max(low, 1e-300));
      result.ticks.callback = (value) => {
        if (decades < 1.5) {
          const digit = value.toExponential(0)[0];  // labels at 1, 2, 5 leave room for each other
          return "125".includes(digit) ? String(Number(value.toPrecision(1))) : "";
        }
        return decade(value) ? "10" + [...String(Math.round(Math.log10(value)))].map((c) => raised[c]).join("") : "";
      };
    }
    return result;
  };

  // As long a metre on x as on y: the plot takes the height that the data need, then whichever axis has room is widened.
  const spans = (data) => {
    const x = extent(data, "x"), y = extent(data, "y");
    return { x, y, spanX: 1.06 * (x.high - x.low), spanY: 1.1 * (y.high - y.low) };
  };
  const fitHeight = (canvas, data) => {
    const { spanX, spanY } = spans(data);
    const box = canvas.parentElement;
    const height = (box.clientWidth - 60) * spanY / spanX + 90;
    if (Number.isFinite(height)) box.style.height = Math.min(560, Math.max(220, height)) + "px";
  };
  const equalise = (chart, data) => {
    const area = chart.chartArea;
    const { x, y, spanX, spanY } = spans(data);
    const perPixel = Math.max(spanX / area.width, spanY / area.height);
    if (!(perPixel > 0)) return;
    const middle = 0.5 * (x.low + x.high);
    chart.options.scales.x.min = x.low >= 0 ? 0 : middle - 0.5 * perPixel * area.width;
    chart.options.scales.x.max = chart.options.scales.x.min + perPixel * area.width;
    chart.options.scales.y.min = y.low >= 0 ? 0 : y.low - 0.03 * spanY;
    chart.options.scales.y.max = chart.options.scales.y.min + perPixel * area.height;
    chart.update("none");
  };

  const draw = (holder) => {
    const data = JSON.parse(holder.textContent);
    const canvas = document.getElementById(holder.dataset.canvas);
    const colours = { ink: style("--ink"), soft: style("--soft"), line: style("--line"), shade: style("--warn"), paper: style("--card") };
    const palette = isDark() ? darkColours : lightColours;
    const datasets = data.series.map((series, index) => {
      const colour = palette[index % palette.length];
      const crowded = series.data.length > 1200;
      return {
        label: series.name,
        data: series.data,
        showLine: series.line,
        borderColor: crowded ? withAlpha(colour, 0.6) : colour,
        backgroundColor: withAlpha(colour, 0.85),
        borderWidth: crowded ? 0.7 : 2,
        borderDash: series.dashed ? [7, 4] : [],
        pointStyle: series.points ? markers[index % markers.length] : "line",
        pointRadius: series.points ? 4.5 : 0,
        pointHitRadius: 8,
        spanGaps: false,
      };
    });
    if (data.equal) fitHeight(canvas, data);
    const chart = new Chart(canvas, {
      type: "scatter",
      data: { datasets },
      options: {
        animation: false,
        maintainAspectRatio: false,
        responsive: true,
        font: { family: getComputedStyle(document.body).fontFamily },
        scales: { x: scale(data, "x", colours), y: scale(data, "y", colours) },
        plugins: {
          legend: {
            display: datasets.length > 1,
            labels: { color: colours.ink, usePointStyle: true, boxWidth: 28, padding: 16 },
          },
          tooltip: {
            callbacks: {
              label: (item) => {
                const point = item.raw;
                const error = point.e > 0 ? " ± " + Number(point.e.toPrecision(3)) : "";
                return item.dataset.label + ": " + Number(point.x.toPrecision(6)) + ", " + Number(point.y.toPrecision(6)) + error;
              },
            },
          },
          bandsAndErrors: { bands: data.bands, windows: data.windows, ink: colours.ink, shade: colours.shade, paper: colours.paper },
        },
      },
      plugins: [bandsAndErrors],
    });
    if (data.equal) equalise(chart, data);
    return chart;
  };

  // A chart counts as drawn if its canvas holds ink in more than one place.
  const hasInk = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let inked = 0;
    for (let i = 3; i < data.length; i += 4) if (data[i] > 0) ++inked;
    return inked > 500;
  };

  let charts = [];
  const drawAll = () => {
    for (const chart of charts) chart.destroy();
    charts = [];
    const holders = [...document.querySelectorAll("script.chart-data")];
    root.dataset.chartsExpected = holders.length;
    for (const holder of holders) {
      try {
        charts.push(draw(holder));
      } catch (error) {
        problem(holder.dataset.canvas + ": " + error.message);
      }
    }
    root.dataset.chartsDrawn = charts.filter((chart) => hasInk(chart.canvas)).length;
  };

  drawAll();
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
  window.addEventListener("beforeprint", drawAll);
  window.addEventListener("afterprint", drawAll);
})();
