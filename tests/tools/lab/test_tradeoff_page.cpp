// Files of a trade-off beside its rows: charts of their own, and a page with pictures.
#include <random>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tools/lab/tradeoff/page/trade_page.h"
#include "tools/scene/chart/chart.h"
#include "tools/scene/chart/template.h"
#include "tools/scene/pictures/thumbnail.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

std::size_t times_in(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

Chart small_chart() {
  Chart chart;
  chart.x_kind = chart.y_kind = AxisSteps::decades;
  chart.x_name = "time, s";
  chart.y_name = "error <mm> & \"more\"";
  chart.floor_name = "floor";
  chart.floor = 1e-3;
  chart.curves = {{"relaxed, \u03bd", {{0.1, 0.09, 0.2, 1, "a\n'b' \x1b[31m", "#row-2"}}},
                  {"slow", {{1, 1, 1, 1e-4, "below", "#row-3"}}}};
  chart.misses = {{1, true, "too slow", "#row-4"}, {0, false, "failed", "#row-5"}};
  chart.front = chart.curves[0].points;
  return chart;
}

TEST(UnitTradeChart, AFileOfItsOwnIsXmlThatAsksForNothing) {
  const TemporaryFolder folder;
  const std::string svg = to_svg_file(small_chart());
  write_text(folder / "chart.svg", svg);
  EXPECT_TRUE(runs_python(
      "-c \"import sys, xml.etree.ElementTree as t; r = t.parse(sys.argv[1]).getroot(); "
      "s = '{http://www.w3.org/2000/svg}'; assert r.tag == s + 'svg' and int(r.get('width')) > 0; "
      "assert len(r.findall('.//' + s + 'circle')) == 4; assert len(r.findall(s + 'style')) == "
      "1\" " +
      (folder / "chart.svg")));
  EXPECT_NE(svg.find("font-family=\"sans-serif\""), std::string::npos);
  EXPECT_EQ(times_in(svg, "http"), 1u) << "the name of SVG alone";
  EXPECT_EQ(svg.find("href"), std::string::npos) << "rows are on the page";
  EXPECT_EQ(svg.find("var("), std::string::npos) << "programs for printing know no variables";
}

TEST(UnitTradeChart, InThePageItLeadsToItsRowsAndHasThePagesStyle) {
  const std::string svg = to_svg(small_chart());
  EXPECT_EQ(times_in(svg, "href=\"#row-"), 4u);
  EXPECT_EQ(svg.find("<style"), std::string::npos);
  EXPECT_EQ(svg.find("<?xml"), std::string::npos);
}

TEST(UnitThumbnail, APixelIsTheMeanOfWhatItCoversOnWhite) {
  Image image(6, 2);
  for (int n = 0; n < 12; ++n) {
    image.rgba[4ul * n] = n % 6 < 3 ? 255 : 0;  // red on the left, black on the right
    image.rgba[4ul * n + 3] = 255;
  }
  const Image small = shrunk(image, 2);
  ASSERT_EQ(small.width, 2);
  ASSERT_EQ(small.height, 1);
  EXPECT_EQ(small.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 0, 255}));
  const Image split = shrunk(image, 4);  // a pixel and a half each
  EXPECT_EQ(split.rgba[4], 255);
  EXPECT_EQ(split.rgba[8], 0);
  EXPECT_EQ(shrunk(image, 1).rgba[0], 128);
  for (std::size_t n = 3; n < image.rgba.size(); n += 4) image.rgba[n] = 0;
  EXPECT_EQ(shrunk(image, 1).rgba, (std::vector<std::uint8_t>{255, 255, 255, 255}));
  EXPECT_EQ(shrunk(image, 100).width, 6);
}

TEST(UnitTemplate, SectionsStandForItemsAndForWhatIsThere) {
  const Value values = {{"name", "a<b"},
                        {"none", nullptr},
                        {"list", Value::List{{{"name", "x"}}, {{"other", 0.25}}}},
                        {"empty", Value::List()},
                        {"words", std::vector<std::string>{"p", "q"}},
                        {"size", 0},
                        {"is_off", false}};
  EXPECT_EQ(filled("{{name}} {{&name}} {{size}}", values), "a&lt;b a<b 0");
  EXPECT_EQ(filled("{{#list}}[{{name}}]{{/list}}{{#words}}{{.}}{{/words}}", values),
            "[x][a&lt;b]pq");
  EXPECT_EQ(filled("{{#none}}1{{/none}}{{#empty}}2{{/empty}}{{#is_off}}3{{/is_off}}{{#no}}4{{/no}}",
                   values),
            "");
  EXPECT_EQ(filled("{{^none}}1{{/none}}{{^empty}}2{{/empty}}{{^size}}3{{/size}}", values), "12");
  EXPECT_EQ(filled("{{#none}}{{#list}}x{{/list}}y{{/none}}z", values), "z");
  EXPECT_EQ(filled("a\n{{#list}}\nb\n{{/list}}\nc\n", values), "a\nb\nb\nc\n");
  EXPECT_THROW(filled("{{missing}}", values), std::out_of_range);
}

/// A reference and so many rows of a scene; each slower and less wrong than the one before it.
TradeResults results_with(const std::string& picture, int count) {
  TradeResults results;
  TradeScene scene;
  scene.file = "a.toml";
  scene.name = "a";
  scene.floor_mm = 1e-6;
  results.scenes = {scene};
  for (int n = 0; n <= count; ++n) {
    TradeRow row;
    row.scene = "a.toml";
    row.method = n == 0 ? "fem" : "relax-6";
    row.knob = n + 1;
    row.status = "ok";
    row.solve_s = {1.0 + n, 1.0 + n, 1.0 + n};
    row.p95_mm = n == 0 ? 0 : 1.0 / n;
    row.command = "supple run a.toml --method " + row.name() + " -o 'x & y'";
    row.picture = picture;
    results.rows.push_back(row);
  }
  return results;
}

TEST(UnitThumbnail, APageOfThirtyRowsHoldsTheirPicturesInLessThanTwoMegabytes) {
  const TemporaryFolder folder;
  Image noise(400, 300);  // the worst for JPEG
  std::mt19937 random(7);
  for (std::uint8_t& value : noise.rgba) value = std::uint8_t(random());
  write_png(folder / "noise.png", noise);
  const std::string page = trade_page(results_with(folder / "noise.png", 30));
  EXPECT_EQ(times_in(page, "src=\"data:image/jpeg;base64,/9j/"), 31u);
  EXPECT_EQ(times_in(page, "width=\"160\" height=\"120\""), 31u);
  EXPECT_LT(page.size(), 2000000u);
  EXPECT_NE(page.find("alt=\"Picture of supple run a.toml --method relax-6:2 -o &#39;x &amp; y"),
            std::string::npos);
}

TEST(UnitThumbnail, RowsWithoutAPictureHaveNone) {
  const TemporaryFolder folder;
  write_text(folder / "no.png", "no picture");
  for (const std::string& picture : {std::string(), folder / "missing.png", folder / "no.png"}) {
    const std::string page = trade_page(results_with(picture, 3));
    EXPECT_EQ(page.find("<img"), std::string::npos) << picture;
    EXPECT_EQ(page.find("Pictures</h3>"), std::string::npos) << picture;
  }
}

TEST(UnitTradePage, ATimeThatNoClockShowsStandsInTheDiagram) {
  TradeResults results = results_with("", 3);
  results.rows[1].solve_s = {0, 0, 0};
  const std::string page = trade_page(results);
  EXPECT_NE(page.find(">1e-06<"), std::string::npos);
  const std::size_t nan = page.find("nan\"");
  EXPECT_EQ(nan, std::string::npos) << page.substr(nan > 200 ? nan - 200 : 0, 300);
  EXPECT_EQ(page.find("inf\""), std::string::npos);
}

TEST(UnitTradePage, EachDiagramIsAFileAndEachRowHasItsPicture) {
  const TemporaryFolder folder;
  write_ball(folder, "ball", 10);
  write_soft_material(folder / "m.toml");
  write_text(folder / "load.toml",
             "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"m.toml\"\n[[step]]\n"
             "grab = [5, 8, 5]\nby = [0.0, 0.6, 0.0]\nfix = [[0, 0, 0, 9, 2, 9]]\n"
             "[[view]]\nimage = \"ball.png\"\nsize = [64, 48]\n");
  const Outcome outcome = run_supple({"tradeoff", folder / "load.toml", "-o", folder / "out",
                                      "--runs", "1", "--method", "ecm", "--drawing", "draw:1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"error_time_load.svg", "likeness_time_load.svg"}) {
    const std::string svg = read_text((folder / "out/") + name);
    EXPECT_NE(svg.find("</svg>"), std::string::npos) << name;
  }
  const std::string page = read_text(folder / "out/index.html");
  EXPECT_EQ(times_in(page, "<img width=\"64\" height=\"48\""), 6u)
      << "finite elements, three of ECM, the drawing and its reference";
  EXPECT_NE(page.find("alt=\"Picture of supple run"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "the page asks for nothing";
}

}  // namespace
