// The page runs in a real browser: its script draws, plays, scrubs and answers keys, without asking the network for
// anything. The still is well-formed and shows the scene.
#include "runtime/tool/viewer/viewer.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "runtime/tool/run/output.hpp"
#include "runtime/tool/viewer/marks.hpp"
#include "tests/runtime/tool/viewer/browser.hpp"

namespace cdot::test {
namespace {

Scene short_scene(const char* name, double duration) {
  Scene scene = scene_named(name);
  scene.duration = duration;
  return scene;
}

std::string attribute(const std::string& document, const std::string& element, const std::string& name) {
  const std::size_t at = document.find(element);
  if (at == std::string::npos) return "no " + element;
  const std::size_t start = document.find(name + "=\"", at);
  if (start == std::string::npos) return "no " + name;
  const std::size_t first = start + name.size() + 2;
  return document.substr(first, document.find('"', first) - first);
}

using Page = PageTest;

TEST_F(Page, ScriptRunsAndShowsTheTimeAskedFor) {
  const Scene scene = short_scene("double_pendulum", 1);
  const std::vector<Frame> film = film_of(scene);
  const std::string document = rendered(html_page(scene, film), "#t=0.5");
  EXPECT_EQ(attribute(document, "<html", "data-ready"), std::to_string(film.size()));
  EXPECT_EQ(attribute(document, "<html", "data-time"), "0.5");
  const View view = view_of(scene, film);
  const Frame& middle = *std::find_if(film.begin(), film.end(), [](const Frame& f) { return f.time > 0.4999; });
  for (std::size_t body = 0; body < 2; ++body) {
    double x = 0, y = 0, degrees = 0;
    const std::string shown = attribute(document, fmt::format("data-body=\"{}\"", body), "transform");
    ASSERT_EQ(std::sscanf(shown.c_str(), "translate(%lf %lf) rotate(%lf)", &x, &y, &degrees), 3) << shown;
    const Place place = place_of(view, middle.bodies[body]);
    EXPECT_NEAR(x, place.x, 0.5);
    EXPECT_NEAR(y, place.y, 0.5);
    EXPECT_NEAR(degrees, place.degrees, 0.5);
  }
}

// The method that was chosen, its price and the error that it delivers, as in the terminal.
TEST_F(Page, TellsWhatTheSearchChose) {
  const TemporaryFolder folder;
  const auto page = folder / "page.html";
  const CommandResult ran = cdot_run(
      fmt::format("simulate '{}' --html '{}'", (scenes_dir() / "double_pendulum.toml").string(), page.string()));
  ASSERT_EQ(ran.status, 0);
  const std::string text = read_text(page);
  const std::size_t from = ran.out.find("  accuracy  "),
                    to = ran.out.find(", ", ran.out.find(" times the run's price"));
  const std::string report = ran.out.substr(from, to - from);
  EXPECT_NE(text.find(report), std::string::npos) << report;
  EXPECT_NE(report.find("  search          1 run before, at "), std::string::npos);
  EXPECT_NE(text.find("2 bodies, 2 joints, dop853, local error "), std::string::npos);
}

// Each sensor is a plot of its own, with its range and its present value.
TEST_F(Page, PlotsSensors) {
  const std::string text = read_text(scenes_dir() / "simple_pendulum.toml") +
                           "\n[[sensor]]\nname = \"clock\"\nvalue = \"2 * time\"\n"
                           "[[sensor]]\nname = \"joules\"\nvalue = \"kinetic\"\n";
  Scene scene = read_scene(std::string_view(text), "test.toml");
  scene.duration = 1;
  const auto seen = seen_by(html_page(scene, film_of(scene)), R"(
      document.dispatchEvent(new KeyboardEvent('keydown', {key: 'End'}));
      seen.plots = document.querySelectorAll('.plot polyline:not(.grid)').length;
      seen.names = [...document.querySelectorAll('figcaption span')].map(e => e.textContent).join();
      seen.range = document.getElementById('sensor0-range').textContent;
      seen.now = document.getElementById('sensor0-now').textContent;
      const ticks = axis => [...document.getElementById('sensor0').closest('figure').querySelectorAll(
          `.ticks.${axis} i`)].map(e => e.textContent + ' at ' + (e.style.top || e.style.left)).join();
      seen.up = ticks('y'); seen.along = ticks('t');)");
  ASSERT_FALSE(seen.contains("error")) << seen;
  EXPECT_EQ(seen["plots"], 4);
  EXPECT_EQ(seen["names"], "energy [J],worst joint error |C|,clock [s],joules [J]");
  EXPECT_EQ(seen["range"], "0 … 2 s");
  EXPECT_EQ(seen["now"], "2 s");
  EXPECT_EQ(seen["up"], "0 at 95%,0.5 at 72.5%,1 at 50%,1.5 at 27.5%,2 at 5%");
  EXPECT_EQ(seen["along"], "0 at 0%,0.5 at 50%,1 s at 100%");
}

TEST_F(Page, PlaysScrubsAndAnswersKeys) {
  const Scene scene = short_scene("four_bar", 1);
  const auto seen = seen_by(html_page(scene, film_of(scene)), R"(
      const root2 = document.documentElement, at = () => +root2.dataset.time;
      const place = () => document.querySelector('[data-body="0"]').getAttribute('transform');
      const key = k => document.dispatchEvent(new KeyboardEvent('keydown', {key: k}));
      const click = id => document.getElementById(id).click();
      seen.played = at();
      click('play'); seen.paused = document.getElementById('play').textContent;
      const slider = document.getElementById('scrub');
      slider.value = 0.75; slider.dispatchEvent(new Event('input'));
      seen.scrubbed = at(); seen.placeScrubbed = place();
      slider.value = 0.1; slider.dispatchEvent(new Event('input')); seen.placeElsewhere = place();
      key('End'); seen.end = at(); key('ArrowLeft'); seen.back = at();
      key('Home'); seen.home = at();
      const dark = root2.classList.contains('dark'); key('d');
      seen.toggled = root2.classList.contains('dark') !== dark;
      key('t'); seen.tracesOff = document.getElementById('traces').getAttribute('aria-pressed');
      seen.trace = document.querySelector('.path').getAttribute('points').length;
      seen.plots = document.querySelectorAll('.plot polyline:not(.grid)').length;
      seen.size = document.querySelector('[data-body="0"]').getBoundingClientRect().width;)");
  ASSERT_FALSE(seen.contains("error")) << seen;
  EXPECT_GT(seen["played"], 0.1);
  EXPECT_EQ(seen["paused"], "Play");
  EXPECT_NEAR(seen["scrubbed"], 0.75, 1e-6);
  EXPECT_NE(seen["placeScrubbed"], seen["placeElsewhere"]);
  EXPECT_NEAR(seen["end"], 1, 1e-9);
  EXPECT_LT(seen["back"], 1.0);
  EXPECT_EQ(seen["home"], 0);
  EXPECT_EQ(seen["toggled"], true);
  EXPECT_EQ(seen["tracesOff"], "false");
  EXPECT_GT(seen["trace"], 1000);
  EXPECT_EQ(seen["plots"], 2);
  EXPECT_GT(seen["size"], 5);
}

TEST_F(Page, DrawsOnTheScreen) {
  const Scene scene = short_scene("four_bar", 1);
  // A page of one colour compresses to about 3 kB.
  EXPECT_GT(screenshot(html_page(scene, film_of(scene)), "#t=0.5").size(), 15000u);
}

TEST(Pictures, PageIsSelfContained) {
  const Scene scene = short_scene("slider_crank", 0.02);
  EXPECT_EQ(foreign_to(html_page(scene, film_of(scene))), std::vector<std::string>());
}

TEST(Pictures, NamesCannotBreakOutOfThePage) {
  Scene scene = short_scene("compound_pendulum", 0.1);
  scene.title = "</script><b>\"&";
  const std::string page = html_page(scene, film_of(scene));
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_NE(page.find("&lt;/script&gt;&lt;b&gt;&quot;&amp;"), std::string::npos);
}

TEST(Pictures, EverySceneCanBeDrawn) {
  for (const std::filesystem::path& file : all_scene_files()) {
    Scene scene = read_scene(file.string());
    scene.duration = std::min(scene.duration, 20 * (scene.step > 0 ? scene.step : default_step));
    const std::string still = svg_still(scene, film_of(scene));
    EXPECT_EQ(still.find("nan"), std::string::npos) << file;
    EXPECT_EQ(still.find("inf"), std::string::npos) << file;
    EXPECT_NE(still.find("class=\"trace"), std::string::npos) << file;
  }
}

TEST(Pictures, StillIsWellFormed) {
  const Scene scene = short_scene("four_bar", 0.6);
  const TemporaryFolder folder;
  const std::string path = folder / "still.svg";
  write_file(path, svg_still(scene, film_of(scene)));
  const CommandResult result =
      run_command(fmt::format("python3 -c \"import sys, xml.dom.minidom as d; "
                              "print(len(d.parse(sys.argv[1]).getElementsByTagName('rect')))\" '{}'",
                              path));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "21\n");  // three rods at seven times
}

// Marks move with bodies: a point of the picture equals the point of the world.
TEST(Pictures, PlacesAgreeWithTheWorld) {
  const View view{-1, 2, 100, 500, 500};
  const Place place = place_of(view, {0.5, 1, std::numbers::pi / 6, 0, 0, 0});
  const Vec2 at = position({0, {100 * 0.3, -100 * 0.4}}, {place});
  const double c = std::cos(std::numbers::pi / 6), s = 0.5;
  const double x = 0.5 + c * 0.3 - s * 0.4, y = 1 + s * 0.3 + c * 0.4;
  EXPECT_NEAR(at[0], 100 * (x + 1), 1e-9);
  EXPECT_NEAR(at[1], 100 * (2 - y), 1e-9);
}

}  // namespace
}  // namespace cdot::test
