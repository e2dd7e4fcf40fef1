// The playground in a real browser, used as a person uses it. The engine is the same code compiled for this machine,
// behind a stand-in for the page's Workers. With CDOT_PLAYGROUND=index.html the page with its WebAssembly is used.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <thread>
#include <unistd.h>

#include "derive/play/engine.hpp"
#include "derive/play/page.hpp"
#include "derive/play/server/serve.hpp"
#include "tests/derive/play/chromium.hpp"

namespace cdot::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// A Worker that hands each request to the test, and its answer to the page.
constexpr const char* stand_in = R"(
const standIns = [];
window.Worker = class {
  constructor() { this.number = standIns.push(this) - 1; }
  postMessage({id, text, files}) {
    if (files) setTimeout(() => { this.begun = true; ask(JSON.stringify({worker: this.number, id, files})); }, 50);
    else if (this.begun) ask(JSON.stringify({worker: this.number, id, text}));
    else setTimeout(() => this.onmessage?.({data: {id, crash: 'a request before the engine began'}}));
  }
  terminate() { this.onmessage = null; }
};
window.deliver = (worker, id, answer) => standIns[worker].onmessage?.({data: {id, answer}});
window.addEventListener('error', event => document.documentElement.dataset.broken = event.message);
window.addEventListener('unhandledrejection', event => document.documentElement.dataset.broken = String(event.reason));
)";

constexpr const char* pendulum = R"(
gravity = [0, -10]
step    = 0.001
[[body]]
name     = "bob"
mass     = 2
shape    = { disc = 0.4 }
position = [0, -2]
[[joint]]
type   = "distance"
name   = "string"
bodies = ["world", "bob"]
pa     = [0, 0]
pb     = [0, 0]
)";

class Playground : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "engine");
    std::ofstream(folder_ / "engine/engine.js") << "";
    std::ofstream(folder_ / "engine/engine.wasm", std::ios::binary) << std::string("\0asm\1\0\0\0", 8);
    fs::current_path(folder_);
  }
  void TearDown() override {
    browser_.reset();
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  // Opens the page with a scene to begin with, and waits for its engine.
  void open(const std::string& scene) {
    std::ofstream("scene.toml") << scene;
    fs::path page = folder_ / "index.html";
    const char* const built = std::getenv("CDOT_PLAYGROUND");
    if (built) page = built;
    else std::ofstream(page) << play::playground_page((folder_ / "scene.toml").string(), specs_, folder_ / "engine");
    browser_.emplace("file://" + page.string(), built ? "" : stand_in,
                     [this](const std::string& text) { answer(json::parse(text)); });
    ASSERT_TRUE(until("document.documentElement.dataset.edition === '1'"));
    if (!built) return;
    write("scene", scene);
    ASSERT_TRUE(until("document.documentElement.dataset.edition === '2'"));
  }

  void answer(const json& request) {
    play::Engine& engine = engines_[request["worker"]];
    std::string text = "{}";
    if (request.contains("files")) engine.ask(json{{"do", "write"}, {"files", request["files"]}}.dump());
    else text = engine.ask(request["text"]);
    browser_->value(
        fmt::format("deliver({}, {}, {})", request["worker"].get<int>(), request["id"].get<int>(), json(text).dump()));
  }

  json value(const std::string& expression) { return browser_->value(expression); }
  bool until(const std::string& expression) {
    const bool came = browser_->becomes_true(expression);
    EXPECT_TRUE(came) << expression << "\nhint: " << value("document.getElementById('hint').textContent")
                      << "\nmessages: " << value("document.getElementById('messages').textContent");
    EXPECT_EQ(value("document.documentElement.dataset.broken ?? ''"), "");
    return came;
  }
  // Replaces the text of a tab.
  void write(const std::string& tab, const std::string& text) {
    browser_->click("#tab-" + tab);
    browser_->click("#editor");
    browser_->type(text);
  }
  void pause() {
    browser_->click("#play");
    ASSERT_TRUE(until("document.getElementById('play').textContent === 'Play'"));
  }
  std::array<double, 2> place() {
    const json bodies = json::parse(value("document.documentElement.dataset.bodies").get<std::string>());
    return {bodies[0], bodies[1]};
  }

  double from_origin() {
    const std::array<double, 2> at = place();  // of one picture
    return std::hypot(at[0], at[1]);
  }

  std::optional<Chromium> browser_;
  const fs::path folder_ = fs::temp_directory_path() / fmt::format("cdot_playground_{}", getpid());
  const fs::path specs_ = fs::path(CDOT_SOURCE_DIR) / "specs";

 private:
  const fs::path before_ = fs::current_path();
  std::map<int, play::Engine> engines_;
};

TEST_F(Playground, MovesAndShowsItsDerivation) {
  open(pendulum);
  ASSERT_TRUE(until("+document.documentElement.dataset.time > 0.2"));
  EXPECT_NEAR(from_origin(), 2, 1e-6);
  EXPECT_EQ(value("document.documentElement.dataset.derived"), "specs/planar/distance.joint");
  EXPECT_GT(value("document.querySelectorAll('#lecture math').length").get<int>(), 5);
  // The string carries the bob: m g.
  EXPECT_NEAR(std::stod(value("document.querySelectorAll('#plots b')[2].textContent").get<std::string>()), 20, 0.1);
}

// A joint is typed anew, with a mistake on the way.
TEST_F(Playground, ATypedJointMoves) {
  open(pendulum);
  write("spec", "joint distance planar\n  point pa on a\n  point pb on b\n  nrm(pa - pb) = 2\n");
  ASSERT_TRUE(until("document.querySelector('#messages .error')"));
  EXPECT_NE(value("document.querySelector('#messages .error').textContent").get<std::string>().find("norm"),
            std::string::npos);
  const std::string mine = "joint my_distance planar\n  point pa on a\n  point pb on b\n  norm(pa - pb) = 3 [m]\n";
  browser_->click("#editor");
  browser_->type(mine);
  ASSERT_TRUE(until("document.documentElement.dataset.derived === 'specs/planar/my_distance.joint'"));
  browser_->click("#tab-scene");
  const std::string scene = value("document.getElementById('editor').value");
  EXPECT_NE(scene.find("type   = \"my_distance\""), std::string::npos) << scene;
  write("scene", std::string(scene).replace(scene.find("[0, -2]"), 7, "[3, 0]"));
  ASSERT_TRUE(
      until("+document.documentElement.dataset.time > 0.1 && "
            "Math.abs(JSON.parse(document.documentElement.dataset.bodies)[0] - 3) < 0.5"));
  EXPECT_NEAR(from_origin(), 3, 1e-6);
}

// A copy of a spring on the string's turn is typed anew: it pushes with its whole force, so the bob stands aside.
TEST_F(Playground, ATypedEffectActs) {
  std::string scene = pendulum;
  scene.replace(scene.find("distance"), 8, "revolute");
  scene.replace(scene.find("pa     = [0, 0]\npb     = [0, 0]"), 31,
                "at     = [0, 0]\nangle.spring = { stiffness = 20, damping = 8 }");
  open(scene);
  value(
      "(() => { const s = document.getElementById('joints'); s.value = 'coordinate/spring'; s.dispatchEvent(new "
      "Event('change')); "
      "})()");
  ASSERT_TRUE(until("document.documentElement.dataset.derived === 'specs/coordinate/spring.effect'"));
  write("spec",
        "effect spring coordinate\n  coordinate s [any]\n  scalar stiffness [J/any]\n"
        "  scalar damping [J*s/any^2]\n  force on s = stiffness - damping * rate(s)\n");
  ASSERT_TRUE(until("document.documentElement.dataset.derived === 'specs/planar/my_spring.effect'"));
  EXPECT_NE(value("texts.scene").get<std::string>().find("angle.my_spring = {"), std::string::npos);
  // m g l sin(angle) = 20 N m, of 40
  ASSERT_TRUE(until("Math.abs(JSON.parse(document.documentElement.dataset.bodies)[0] - 1) < 1e-3"));
}

// Pointing at a name of the derivation lights it up in the picture and in the kernel; pointing at J shows the force.
TEST_F(Playground, PointingLightsUp) {
  open(pendulum);
  ASSERT_TRUE(until("document.querySelector('#code [data-name=ra]')"));
  const auto point_at = [&](const char* name) {
    value(
        fmt::format("document.querySelector('#lecture [data-name={}]').dispatchEvent(new PointerEvent('pointerover', "
                    "{{bubbles: true}}))",
                    name));
  };
  point_at("ra");
  EXPECT_TRUE(until("document.querySelectorAll('#code .lit').length > 1"));
  EXPECT_TRUE(until("marks && marks.arrows.some(arrow => arrow.name === 'ra')"));
  EXPECT_EQ(value("[...document.querySelectorAll('.lit')].every(e => e.dataset.name === 'ra')"), true);
  point_at("J");
  EXPECT_TRUE(until("lit.has('J') && marks && Math.abs(marks.forces[0].force[1] - 20) < 0.5"));
}

TEST_F(Playground, NewSpecsAreInTheGallery) {
  open(pendulum);
  const json titles = value("data.gallery.map(one => one.title)");
  for (const char* title :
       {"new joint, in the plane", "new joint, in space", "new effect, in the plane", "new effect, on a coordinate"}) {
    const auto place = std::find(titles.begin(), titles.end(), title) - titles.begin();
    ASSERT_LT(place, titles.size()) << title;
    value(
        fmt::format("(() => {{ const s = document.getElementById('gallery'); s.value = {}; s.dispatchEvent(new "
                    "Event('change')); }})()",
                    place));
    ASSERT_TRUE(
        until("/^specs.*my_/.test(document.documentElement.dataset.derived) && live && "
              "+document.documentElement.dataset.time > 0.1"));
    EXPECT_EQ(value("document.querySelectorAll('#messages .error').length"), 0) << title;
  }
}

TEST_F(Playground, ADerivationByHandIsJudged) {
  open(pendulum);
  browser_->click("#tab-hand");
  ASSERT_TRUE(until("/\\d/.test(document.documentElement.dataset.judged)"));
  const auto judged = [&](const std::string& J, const std::string& verdict) {
    browser_->click("#editor");
    browser_->type("entry X-1 \"mine\"\n  source \"me\"\n  J = " + J + "\n");
    return until(fmt::format("document.documentElement.dataset.judged === '{}'", verdict));
  };
  ASSERT_TRUE(judged("[n', cross(ra, n), -n', cross(rb, n)]", "0 agree, 1 differ"));
  EXPECT_NE(
      value("document.querySelector('#messages .error').textContent").get<std::string>().find("the sign is wrong"),
      std::string::npos);
  ASSERT_TRUE(judged("[n', cross(ra, n), -n', -cross(rb, n)]", "1 agree, 0 differ"));
  EXPECT_EQ(value("document.querySelectorAll('#messages .agrees').length"), 1);
  EXPECT_EQ(value("document.querySelectorAll('#messages .error').length"), 0);
}

// The pointer takes the bob to the right of the point that it hangs from.
TEST_F(Playground, ABodyFollowsThePointer) {
  open(pendulum);
  ASSERT_TRUE(until("+document.documentElement.dataset.time > 0.1"));
  const json at = value(
      "(() => { const r = stage.getBoundingClientRect(), p = view.project(view.places[0].x),"
      " q = view.project([3, 0, 0]); return [r.x + p[0], r.y + p[1], r.x + q[0], r.y + q[1]]; })()");
  browser_->mouse("mousePressed", at[0], at[1]);
  for (int k = 1; k <= 10; ++k)
    browser_->mouse("mouseMoved", at[0].get<double>() + k * (at[2].get<double>() - at[0].get<double>()) / 10,
                    at[1].get<double>() + k * (at[3].get<double>() - at[1].get<double>()) / 10);
  EXPECT_TRUE(until("JSON.parse(document.documentElement.dataset.bodies)[0] > 1.5"));
  browser_->mouse("mouseReleased", at[2], at[3]);
  EXPECT_TRUE(until("JSON.parse(document.documentElement.dataset.bodies)[0] < 0"));  // it swings
  EXPECT_NEAR(from_origin(), 2, 1e-6);
}

// By keys alone: pause, choose, pull, tell, let go.
TEST_F(Playground, TheKeyboardIsEnough) {
  open(pendulum);
  value("stage.focus()");
  browser_->key("b");
  EXPECT_TRUE(until("/^bob/.test(document.getElementById('spoken').textContent)"));
  for (int k = 0; k < 10; ++k) browser_->key("ArrowRight", true);
  EXPECT_TRUE(until("JSON.parse(document.documentElement.dataset.bodies)[0] > 0.05"));
  browser_->key(" ");
  EXPECT_TRUE(until("document.getElementById('play').textContent === 'Play'"));
  browser_->key("d");
  EXPECT_TRUE(until("/bob at 0\\.\\d\\d, -[12]\\.\\d\\d/.test(document.getElementById('spoken').textContent)"));
  browser_->key("Escape");
  EXPECT_EQ(value("hand"), json());
}

TEST_F(Playground, ParametersAndGravityMove) {
  open(pendulum);
  ASSERT_TRUE(until("+document.documentElement.dataset.time > 0.1"));
  const auto slide = [&](const std::string& range, double to) {
    value(fmt::format("(() => {{ const s = {}; s.value = {}; s.dispatchEvent(new Event('input')); }})()", range, to));
  };
  value("document.getElementById('parameters').open = true");
  EXPECT_EQ(value("document.querySelector('#sliders label').textContent"), "l of string 2 m");
  slide("document.querySelector('#sliders input')", 2.5);
  EXPECT_TRUE(
      until("Math.abs(Math.hypot(...JSON.parse(document.documentElement.dataset.bodies).slice(0, 2)) - 2.5) < 0.02"));
  slide("document.getElementById('gravity')", 0);
  EXPECT_TRUE(until("Math.abs(+document.querySelectorAll('#plots b')[2].textContent) < 5"));
  EXPECT_EQ(value("document.querySelector('#carried select').selectedOptions[0].textContent"), "string");
}

// The error of long steps by Euler is felt, and falls with the steps.
TEST_F(Playground, AccuracyAndItsPriceAreShown) {
  open(std::string(pendulum).replace(std::string(pendulum).find("[0, -2]"), 7, "[2, 0]"));
  const auto choose = [&](const char* id, const char* option) {
    value(
        fmt::format("(() => {{ const s = document.getElementById('{0}'); s.value = '{1}'; s.checked = true;"
                    "s.dispatchEvent(new Event('change')); }})()",
                    id, option));
  };
  choose("measure", "on");
  choose("method", "euler");
  choose("rate", "60");
  EXPECT_TRUE(until("+document.querySelectorAll('#plots b')[3].textContent > 1e-6"));
  EXPECT_TRUE(until("/ms of computing per second/.test(document.getElementById('cost').textContent)"));
}

// Each change of the text begins anew, also while the engine before it begins.
TEST_F(Playground, TheLastOfManyChangesWins) {
  open(pendulum);
  value("(async () => { for (let k = 0; k < 4; ++k) { reload(); await new Promise(done => setTimeout(done)); } })()");
  EXPECT_TRUE(until(
      "live && +document.documentElement.dataset.time > 0.1 && document.documentElement.dataset.edition == edition"));
}

// A server on a free port, while it lives.
class Serving {
 public:
  Serving(const std::string& start, const fs::path& specs, const fs::path& engine)
      : server_(start, specs, engine, CDOT_PLAY, 0), thread_([this] { server_.run(); }) {}
  ~Serving() {
    server_.stop();
    thread_.join();
  }
  std::string address() const { return server_.address(); }

 private:
  play::PageServer server_;
  std::thread thread_;
};

// `cdot play`: the page is served, and follows the scene and a spec beside it as they change on disk.
TEST_F(Playground, AServedPageFollowsTheFiles) {
  std::ofstream("scene.toml") << pendulum;
  const Serving serving((folder_ / "scene.toml").string(), specs_, folder_ / "engine");
  browser_.emplace(serving.address(), stand_in, [this](const std::string& text) { answer(json::parse(text)); });
  EXPECT_TRUE(until("document.documentElement.dataset.edition === '1' && live"));
  std::string scene = pendulum;
  scene.replace(scene.find("distance"), 8, "rod_of_3");
  std::ofstream("rod_of_3.joint")
      << "joint rod_of_3 planar\n  point pa on a\n  point pb on b\n  norm(pa - pb) = 3 [m]\n";
  scene.replace(scene.find("[0, -2]"), 7, "[0, -3]");
  std::ofstream("scene.toml") << scene;
  EXPECT_TRUE(
      until("document.documentElement.dataset.derived === 'specs/planar/rod_of_3.joint' && "
            "Math.abs(JSON.parse(document.documentElement.dataset.bodies)[1] + 3) < 1e-6"));
}

// Without WebAssembly the page asks the machine that serves it; a joint is typed, and moves.
TEST_F(Playground, AServedPageNeedsNoWebAssembly) {
  std::ofstream("scene.toml") << pendulum;
  const Serving serving((folder_ / "scene.toml").string(), specs_, folder_ / "no_engine");
  browser_.emplace(serving.address(), "", [](const std::string&) {});
  EXPECT_TRUE(
      until("document.documentElement.dataset.edition === '1' && +document.documentElement.dataset.time > 0.1"));
  EXPECT_NEAR(from_origin(), 2, 1e-6);
  ASSERT_TRUE(until("document.querySelector('#code [data-name=ra]')"));
  write("spec", "joint distance planar\n  point pa on a\n  point pb on b\n  norm(pa - pb) = 2 [m]\n");
  ASSERT_TRUE(until("document.documentElement.dataset.derived === 'specs/planar/my_distance.joint'"));
  // An engine that ends is told, and begins anew.
  value("mover.ask({do: 'step', time: 1e300}, 0.2)");
  value("reload()");
  ASSERT_TRUE(until("live && +document.documentElement.dataset.time > 0.1"));
}

// On a phone nothing is wider than the screen, and the mechanism comes first.
TEST_F(Playground, FitsAPhone) {
  open(pendulum);
  browser_->resize(390, 844);
  EXPECT_TRUE(until("document.documentElement.scrollWidth <= 390"));
  EXPECT_LT(value("stage.getBoundingClientRect().top").get<double>(), 200);
  EXPECT_GT(value("stage.getBoundingClientRect().height").get<double>(), 300);
}

// The first picture and its derivation are there before any engine answers.
TEST_F(Playground, TheFirstSightNeedsNoEngine) {
  std::ofstream("scene.toml") << pendulum;
  std::ofstream("index.html") << play::playground_page("scene.toml", fs::path(CDOT_SOURCE_DIR) / "specs", "engine");
  browser_.emplace("file://" + fs::absolute("index.html").string(), stand_in, [](const std::string&) {});
  EXPECT_TRUE(until("document.documentElement.dataset.bodies"));
  EXPECT_DOUBLE_EQ(place()[1], -2);
  EXPECT_EQ(value("document.documentElement.dataset.derived"), "specs/planar/distance.joint");
}

}  // namespace
}  // namespace cdot::test
