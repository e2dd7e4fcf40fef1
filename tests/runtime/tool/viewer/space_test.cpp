// The page of a scene in space, in a real browser: bodies at the film's poses, an orbiting camera, the same controls as
// in the plane.
#include "runtime/tool/viewer/space.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>

#include <cdot/rotation.hpp>

#include "runtime/tool/viewer/viewer.hpp"
#include "tests/runtime/tool/viewer/browser.hpp"

namespace cdot::test {
namespace {

std::vector<double> numbers_of(std::string path) {
  for (char& c : path)
    if (std::isalpha(static_cast<unsigned char>(c))) c = ' ';
  std::istringstream text(path);
  return {std::istream_iterator<double>(text), {}};
}

class SpacePage : public PageTest {
 protected:
  void SetUp() override {
    PageTest::SetUp();
    scene_ = scene_named("spatial/torque_free_body");
    scene_.duration = 2;
    film_ = film_of(scene_);
  }
  Scene scene_;
  std::vector<Frame> film_;
};

TEST_F(SpacePage, BodiesAreWhereTheFilmHasThem) {
  const auto seen = seen_by(html_page(scene_, film_), R"(
      seen.point = placed(places[0], [0.3, -0.2, 0.5]);
      seen.time = +document.documentElement.dataset.time;
      seen.faces = document.querySelectorAll('#space [data-body="0"][d^="M"]').length;)",
                            "#t=1");
  ASSERT_FALSE(seen.contains("error")) << seen;
  EXPECT_EQ(seen["time"], 1);
  const Frame& frame = *std::find_if(film_.begin(), film_.end(), [](const Frame& f) { return f.time > 0.99999; });
  const BodyState& b = frame.bodies[0];
  const auto q = spatial::oriented(b.x, b.y, b.z, b.e0, b.e1, b.e2, b.e3);
  const auto p = to_world(q, spatial::Vector<double>{0.3, -0.2, 0.5});
  EXPECT_NEAR(seen["point"][0], b.x + p.x, 1e-3);
  EXPECT_NEAR(seen["point"][1], b.y + p.y, 1e-3);
  EXPECT_NEAR(seen["point"][2], b.z + p.z, 1e-3);
  EXPECT_GE(seen["faces"], 1);  // visible faces of a box
  EXPECT_LE(seen["faces"], 3);
}

TEST_F(SpacePage, PlaysScrubsAndOrbits) {
  const auto seen = seen_by(html_page(scene_, film_), R"(
      const root2 = document.documentElement, at = () => +root2.dataset.time;
      const drawn = () => document.querySelector('#space path').getAttribute('d');
      const key = k => document.dispatchEvent(new KeyboardEvent('keydown', {key: k}));
      seen.played = at();
      document.getElementById('play').click();
      const slider = document.getElementById('scrub');
      slider.value = 0.75; slider.dispatchEvent(new Event('input')); seen.scrubbed = at();
      const there = drawn();
      slider.value = 0.2; slider.dispatchEvent(new Event('input')); seen.moves = drawn() !== there;
      const here = drawn(), camera = root2.dataset.camera;
      stage.dispatchEvent(new PointerEvent(
          'pointermove', {buttons: 1, movementX: 60, movementY: 20}));
      seen.orbits = drawn() !== here && root2.dataset.camera !== camera;
      key('0'); seen.fits = drawn() === here && root2.dataset.camera === camera;
      stage.dispatchEvent(new WheelEvent('wheel', {deltaY: -200})); seen.zooms = drawn() !== here;
      key('End'); seen.end = at();
      seen.trace = document.querySelector('.path').getAttribute('points').split(' ').length;
      seen.plots = document.querySelectorAll('.plot polyline:not(.grid)').length;)");
  ASSERT_FALSE(seen.contains("error")) << seen;
  EXPECT_GT(seen["played"], 0.1);
  EXPECT_NEAR(seen["scrubbed"], 1.5, 1e-6);
  for (const char* what : {"moves", "orbits", "fits", "zooms"}) EXPECT_EQ(seen[what], true) << what;
  EXPECT_NEAR(seen["end"], 2, 1e-9);
  EXPECT_EQ(seen["trace"], film_.size());
  EXPECT_EQ(seen["plots"], 2);
}

// Two implementations of one picture: the page's script and the still's C++.
TEST_F(SpacePage, EndsWithThePictureOfTheStill) {
  const auto seen = seen_by(html_page(scene_, film_), R"(
      seen.paths = [...document.querySelectorAll('#space path')].map(p => p.getAttribute('d'))
                       .filter(d => d);)",
                            "#t=2");
  ASSERT_FALSE(seen.contains("error")) << seen;
  const std::string still = space_snapshot(draw_in_space(scene_, film_), film_.back(), true);
  std::vector<std::string> paths;
  for (std::size_t at = 0; (at = still.find(" d=\"", at)) != std::string::npos;) {
    at += 4;
    paths.push_back(still.substr(at, still.find('"', at) - at));
  }
  ASSERT_EQ(seen["paths"].size(), paths.size());
  EXPECT_GE(paths.size(), 2u);
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const std::vector<double> page = numbers_of(seen["paths"][k]), here = numbers_of(paths[k]);
    ASSERT_EQ(page.size(), here.size()) << seen["paths"][k] << " and " << paths[k];
    for (std::size_t i = 0; i < page.size(); ++i)
      EXPECT_NEAR(page[i], here[i], 0.25) << "path " << k << ", number " << i;  // pixels of 1000
  }
}

TEST_F(SpacePage, IsSelfContained) { EXPECT_EQ(foreign_to(html_page(scene_, film_)), std::vector<std::string>()); }

TEST(SpacePictures, EverySceneInSpaceCanBeDrawn) {
  for (const std::filesystem::path& file : files_in(scenes_dir() / "spatial", ".toml")) {
    Scene scene = read_scene(file.string());
    scene.duration = 20 * default_step;
    const std::string page = html_page(scene, film_of(scene));
    EXPECT_EQ(page.find("null"), std::string::npos) << file;  // JSON for NaN
    EXPECT_EQ(svg_still(scene, film_of(scene)).find("nan"), std::string::npos) << file;
  }
}

}  // namespace
}  // namespace cdot::test
