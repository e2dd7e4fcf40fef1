// The top of a scene file: what is simulated, for how long, and how.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <span>

#include <cdot/methods.hpp>

#include "runtime/tool/scene/keys.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

void read_title(Entry& top, const char* key, Scene& scene) { scene.title = top.text(key).value_or(""); }

void read_dimension(Entry& top, const char* key, Scene& scene) {
  const int dimension = top.whole(key, 2).value_or(2);
  if (dimension > 3) top.error(top.where(key), "a scene is planar or in space", "dimension = 2 or 3");
  scene.dimension = dimension == 3 ? Dimension::spatial : Dimension::planar;
}

void read_gravity(Entry& top, const char* key, Scene& scene) {
  const bool in_space = scene.dimension == Dimension::spatial;
  const Vec3 down = in_space ? Vec3{0, 0, -9.81} : Vec3{0, -9.81, 0};
  const Vec3 gravity = read_vector(top, key, scene.dimension).value_or(down);
  scene.settings.gravity_x = gravity[0];
  scene.settings.gravity_y = gravity[1];
  scene.settings.gravity_z = gravity[2];
}

// With a local error the step is only how often the run is looked at.
void read_step(Entry& top, const char* key, Scene& scene) {
  const double step = top.has("local_error") ? scene.duration / 64 : scene.step;
  scene.step = top.number(key, {Sign::positive}).value_or(step);
  if (scene.step > scene.duration)
    top.error(top.where(key),
              fmt::format("the step of {} s is longer than the duration of {} s", scene.step, scene.duration));
}

constexpr auto settings = &Scene::settings;

// clang-format off
constexpr Key<Scene> keys[] = {
    {"title", "shown in pages and summaries", "", read_title},
    {"dimension", "2, or 3: in space", "2", read_dimension},
    {"gravity", "[m/s^2]", "[0, -9.81], in space [0, 0, -9.81]", read_gravity},
    {"duration", "[s]", "10", read_number<Sign::positive, &Scene::duration>},
    {"step", "[s]; the run ends with the first step at or after duration", "0.001", read_step},
    {"solver", "how a step finds the impulses", "direct", read_choice<solvers, settings, &Settings::solver>, Where::everywhere, choices_of<solvers>},
    {"integrator", "how a step is taken", "euler", read_choice<integrators, settings, &Settings::integrator>, Where::everywhere, choices_of<integrators>},
    {"local_error", "rk4 and dop853 choose their steps: the estimated error of one [m, rad, m/s, rad/s]", "fixed steps", read_number<Sign::positive, settings, &Settings::local_error>},
    {"drift", "what keeps joints together", "projection", read_choice<drifts, settings, &Settings::drift>, Where::everywhere, choices_of<drifts>},
    {"baumgarte", "share of the error removed per step", "0.2", read_number<Sign::positive, settings, &Settings::baumgarte>},
    {"iterations", "of the iterative solver", "10", read_count<settings, &Settings::iterations>},
    {"warm_start", "of the iterative solver", "true", read_flag<settings, &Settings::warm_start>},
    {"kernels", "rows of one joint together in the iterative solver", "balanced", read_choice<kernel_forms, settings, &Settings::kernels>, Where::everywhere, choices_of<kernel_forms>},
    {"substeps", "every step is taken as so many shorter ones", "1", read_count<settings, &Settings::substeps>},
    {"precision", "of all numbers", "double", read_choice<precisions, &Scene::single>, Where::everywhere, choices_of<precisions>},
    {"accuracy", "of the trajectory, by a method that the run chooses [m, rad]", "the method as given", read_number<Sign::positive, &Scene::accuracy>},
    {"sleep_after", "bodies at rest for so long sleep [s]; 0: never", "0", read_number<Sign::not_negative, settings, &Settings::sleep_after>},
    {"sleep_speed", "the speed that counts as rest [m/s, rad/s]", "0.001", read_number<Sign::positive, settings, &Settings::sleep_speed>},
    {"tolerance", "joint error from which the run has failed [m, rad]", "0.01", read_number<Sign::positive, &Scene::tolerance>},
    {"project", "move a start that does not fit onto its joints", "false", read_flag<&Scene::project>},
    {"on_failure", "of a step", "stop", read_choice<failure_answers, &Scene::on_failure>, Where::everywhere, choices_of<failure_answers>},
};
// clang-format on

void check_method(Entry& top, const Settings& chosen) {
  if (const char* wrong = wrong_with_methods(chosen))
    top.error(top.where(top.has("drift") ? "drift" : "local_error"), wrong);
  if (chosen.baumgarte > 1)
    top.error(top.where("baumgarte"), "`baumgarte` is the share of the error removed per step: at most 1");
}

// An accuracy stands in the place of a method.
void check_accuracy(Entry& top) {
  if (!top.has("accuracy")) return;
  for (const char* key :
       {"step", "solver", "integrator", "local_error", "drift", "substeps", "iterations", "kernels", "precision"})
    if (top.has(key))
      top.error(top.where(key), fmt::format("`accuracy` chooses the method: `{}` has no say beside it", key),
                fmt::format("leave out `{}`, or `accuracy`", key));
}

}  // namespace

void read_settings(Entry& top, Scene& scene) {
  read_keys(top, keys, scene.dimension, scene);
  check_method(top, scene.settings);
  check_accuracy(top);
}

std::string listed(const std::vector<std::string>& choices) {
  const std::span most(choices.data(), choices.size() - 1);
  return fmt::format("{} or {}", fmt::join(most, ", "), choices.back());
}

KeyTable keys_of_the_top() { return table_of("The top of the file", keys); }

}  // namespace cdot
