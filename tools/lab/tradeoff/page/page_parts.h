// The styles of the page and of its charts, and its script.
#pragma once

namespace supple::tools {

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light; font: 15px/1.45 system-ui, sans-serif; color: #1c1c1c; }
body { max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; } h3 { font-size: 1rem; }
.pictures { display: flex; flex-wrap: wrap; gap: .8rem; margin: .6rem 0; } .pictures figure { margin: 0; width: 160px; font-size: .8rem; }
.pictures img { display: block; max-width: 100%; height: auto; border: 1px solid #ddd; box-sizing: border-box; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: .6rem 0 1.4rem; font-size: .85rem; }
th, td { padding: .18rem .38rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap; }
td.note { text-align: left; white-space: normal; min-width: 9rem; color: #555; }
th:first-child, td:first-child { text-align: left; }
td.text { text-align: left; } tr:target { background: #fff3c4; } td.best { font-weight: 600; }
a { color: inherit; } code { font-size: .85em; background: #f3f3f3; padding: .1em .3em; }
.chart { width: 100%; min-width: 40rem; max-width: 60rem; height: auto; }
.chart .touch { pointer-events: all; } .chart.dim .curve:not(.on) { opacity: .12; } .chart .entry { cursor: pointer; }
#shown { position: sticky; bottom: 0; background: #fff; border-top: 1px solid #ccc; padding: .4rem 0; min-height: 2.6em; font-size: .85rem; white-space: pre-wrap; }
</style>
)";

/// Style of charts, in the page or a file of its own: colours come from the element, and nothing is
/// used that programs for printing do not know, such as variables and colours of eight digits.
constexpr const char* kChartStyle = R"(<style>
.chart { font-size: 12px; }
.chart .grid { stroke: #e2e2e2; } .chart .name { font-weight: 600; } .chart .small { fill: #666; font-size: 11px; }
.chart .floor { fill: #000; fill-opacity: .06; }
.chart .front { fill: none; stroke: #000; stroke-opacity: .19; stroke-width: 7; stroke-linejoin: round; }
.chart .way { fill: none; stroke: currentColor; stroke-width: 1.4; } .chart .whisker { stroke: currentColor; stroke-width: 1.4; }
.chart .point { fill: currentColor; stroke: #fff; stroke-width: .8; }
.chart .hollow { fill: #fff; stroke: currentColor; stroke-width: 1.6; }
.chart .miss line { stroke: currentColor; stroke-width: 2; } .chart .touch { fill: none; }
</style>
)";

/// Shows the words of what the pointer is over below the page, and a legend entry's curve alone.
constexpr const char* kScript = R"(<script>
const shown = document.getElementById('shown');
for (const title of document.querySelectorAll('.chart title')) {
  const mark = title.parentNode, words = title.textContent;
  mark.addEventListener('pointerenter', () => { shown.textContent = words; });
}
for (const entry of document.querySelectorAll('.chart .entry')) {
  const chart = entry.closest('.chart');
  const own = chart.querySelector('.curve[data-curve="' + entry.dataset.curve + '"]');
  entry.addEventListener('pointerenter', () => { chart.classList.add('dim'); own.classList.add('on'); });
  entry.addEventListener('pointerleave', () => { chart.classList.remove('dim'); own.classList.remove('on'); });
}
</script>
)";

}  // namespace supple::tools
