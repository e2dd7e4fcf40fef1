#include "tests/runtime/tool/viewer/browser.hpp"

#include <fmt/format.h>

#include "runtime/tool/run/output.hpp"
#include "runtime/tool/viewer/viewer.hpp"

namespace cdot::test {
namespace {

// With a virtual clock a slow browser draws no frame at all. Frames therefore come from the clock's timers, so the page
// plays equally far on a loaded and on an idle machine.
constexpr std::string_view frames_by_the_clock = R"(<script>
  window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 16);
</script>)";

// Simulates a user of the controls.
constexpr std::string_view person = R"(<pre id="seen"></pre><script>
    const seen = {{}};
    window.addEventListener('error', e => {{ seen.error = e.message; }});
    setTimeout(() => {{
      {}
      document.getElementById('seen').textContent = JSON.stringify(seen);
    }}, 1500);
  </script></body>)";

}  // namespace

std::vector<Frame> film_of(const Scene& scene) {
  RunOptions options;
  options.film_times = film_times(scene);
  std::string warnings;
  return simulate(scene, options, warnings).film;
}

std::vector<std::string> foreign_to(std::string page) {
  const std::string name = "http://www.w3.org/2000/svg";  // a name, not an address to fetch
  for (std::size_t at; (at = page.find(name)) != std::string::npos;) page.erase(at, name.size());
  std::vector<std::string> found;
  for (const char* foreign : {"http:", "https:", "src=", "@import", "url(", "fetch(", "{{"})
    if (page.find(foreign) != std::string::npos) found.push_back(foreign);
  return found;
}

void PageTest::SetUp() { ASSERT_STRNE(CDOT_CHROMIUM, "CDOT_CHROMIUM-NOTFOUND") << "this test needs chromium"; }

std::string PageTest::browse(const std::string& page, const std::string& fragment, const std::string& options) const {
  const std::string path = folder_ / "page.html", profile = folder_ / "profile";
  write_file(path, page);
  const CommandResult result = run_command(
      fmt::format("'{}' --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking "
                  "--disable-component-update --disable-sync --user-data-dir='{}' {} 'file://{}{}'",
                  CDOT_CHROMIUM, profile, options, path, fragment));
  EXPECT_EQ(result.status, 0) << result.err;
  return result.out;
}

std::string PageTest::rendered(const std::string& page, const std::string& fragment) const {
  return browse(page, fragment, "--virtual-time-budget=3000 --dump-dom");
}

nlohmann::json PageTest::seen_by(std::string page, const std::string& script, const std::string& fragment) const {
  page.replace(page.find("</body>"), 7, fmt::format(person, script));
  page.insert(page.find("<script>"), frames_by_the_clock);
  const std::string document = rendered(page, fragment), mark = "<pre id=\"seen\">";
  const std::size_t start = document.find(mark + "{");
  if (start == std::string::npos) return {{"error", "the page's script did not run"}};
  const std::size_t first = start + mark.size();
  return nlohmann::json::parse(document.substr(first, document.find("</pre>", start) - first));
}

std::string PageTest::screenshot(const std::string& page, const std::string& fragment) const {
  const std::string picture = folder_ / "picture.png";
  browse(page, fragment, fmt::format("--window-size=900,600 --virtual-time-budget=500 --screenshot='{}'", picture));
  return read_text(picture);
}

}  // namespace cdot::test
