// The top of a scene file -> the settings, duration and step of a Scene.
#include <algorithm>
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

// Each names a method; without any of them an accuracy chooses it.
constexpr const char* keys_of_methods[] = {"step",      "solver",    "integrator", "local_error",
                                           "drift",     "substeps",  "iterations", "kernels",
                                           "precision", "baumgarte", "warm_start", "sleep_after"};

constexpr const char* picked_integrator = "auto";

void read_step(Entry& top, const char* key, Scene& scene) {
  const bool named = std::ranges::any_of(keys_of_methods, [&](const char* method) { return top.has(method); });
  const double step = named ? usual_step(scene.duration, top.has("local_error")) : 0;
  scene.step = top.number(key, {Sign::positive}).value_or(step);
  if (scene.step > scene.duration)
    top.error(top.where(key),
              fmt::format("the step of {} s is longer than the duration of {} s", scene.step, scene.duration));
}

void read_integrator(Entry& top, const char* key, Scene& scene) {
  name_integrator(scene, top.choice(key, integrator_choices()).value_or(picked_integrator));
}

// Their joints are not read yet.
void read_inputs(Entry& top, const char* key, Scene& scene) { scene.inputs = top.texts(key).value_or(scene.inputs); }

constexpr auto settings = &Scene::settings;

// clang-format off
constexpr Key<Scene> top_keys[] = {
    {"title", "shown in pages and summaries", "", read_title},
    {"dimension", "2, or 3: in space", "2", read_dimension},
    {"gravity", "[m/s^2]", "[0, -9.81], in space [0, 0, -9.81]", read_gravity},
    {"duration", "[s]", "10", read_number<Sign::positive, &Scene::duration>},
    {"step", "time step [s]; the run ends with the first step at or after duration", "chosen by the accuracy, or 0.001 if the scene names a method", read_step},
    {"solver", "solver of the impulses", "direct", read_choice<solvers, settings, &Settings::solver>, Where::everywhere, choices_of<solvers>},
    {"integrator", "method of a step; auto picks one that holds at the step, by what the mechanisms are", "auto; euler with the iterative solver or another drift", read_integrator, Where::everywhere, integrator_choices},
    {"local_error", "the integrator chooses its steps, each with this estimated error [m, rad, m/s, rad/s]", "fixed steps", read_number<Sign::positive, settings, &Settings::local_error>},
    {"drift", "correction of C", "projection, for Euler's steps by sweeps soft", read_choice<drifts, &Scene::drift>, Where::everywhere, choices_of<drifts>},
    {"baumgarte", "share of the error removed per step", "0.2", read_number<Sign::positive, settings, &Settings::baumgarte>},
    {"iterations", "sweeps of the iterative solver per substep", "10", read_count<settings, &Settings::iterations>},
    {"warm_start", "the iterative solver starts from the last impulses", "true", read_flag<settings, &Settings::warm_start>},
    {"kernels", "block solve of the rows of a joint in the iterative solver", "balanced", read_choice<kernel_forms, settings, &Settings::kernels>, Where::everywhere, choices_of<kernel_forms>},
    {"substeps", "number of equal parts of a step", "1", read_count<settings, &Settings::substeps>},
    {"precision", "floating-point precision", "double", read_choice<precisions, &Scene::single>, Where::everywhere, choices_of<precisions>},
    {"accuracy", "error of the trajectory; the run chooses the method [m, rad]", "the method and step as given; without them 1e-4 of each mechanism's size and of 1 rad", read_number<Sign::positive, &Scene::accuracy>},
    {"sleep_after", "bodies sleep after this time at rest [s]; 0: never", "0", read_number<Sign::not_negative, settings, &Settings::sleep_after>},
    {"sleep_speed", "largest speed at rest [m/s, rad/s]", "0.001", read_number<Sign::positive, settings, &Settings::sleep_speed>},
    {"tolerance", "joint error above which the run has failed [m, rad]", "0.01", read_number<Sign::positive, &Scene::tolerance>},
    {"energy_tolerance", "share of the motion's energies and momenta that the method may lose; of energies that it makes up a tenth", "0.1", read_number<Sign::positive, &Scene::energy_tolerance>},
    {"trajectory_tolerance", "share of each mechanism's size, and [rad]: of fixed steps, the estimated error of the trajectory above which the run has failed; a tenth of it warns", "none: 0.1 warns", read_number<Sign::positive, &Scene::trajectory_tolerance>},
    {"project", "project an inconsistent start onto C = 0", "false", read_flag<&Scene::project>},
    {"inputs", "numbers that a step compiled by `cdot compile` may change, as [\"hinge.angle.motor.speed\"]", "none", read_inputs},
    {"on_failure", "reaction to a step that fails", "stop", read_choice<failure_answers, &Scene::on_failure>, Where::everywhere, choices_of<failure_answers>},
};
// clang-format on

void check_method(Entry& top, const Settings& chosen) {
  if (const char* wrong = mistake_in_methods(chosen))
    top.error(top.where(top.has("drift") ? "drift" : "local_error"), wrong);
  if (chosen.baumgarte > 1)
    top.error(top.where("baumgarte"), "`baumgarte` is the share of the error removed per step: at most 1");
}

// An accuracy replaces a method.
void check_accuracy(Entry& top) {
  if (!top.has("accuracy")) return;
  for (const char* key : keys_of_methods)
    if (top.has(key))
      top.error(top.where(key),
                fmt::format("`{}` and `accuracy` exclude each other: `accuracy` chooses the method", key),
                fmt::format("remove `{}` or `accuracy`", key));
}

}  // namespace

void settle_drift(Scene& scene) { scene.settings.drift = scene.drift.value_or(usual_drift(scene.settings)); }

void read_settings(Entry& top, Scene& scene) {
  read_keys(top, top_keys, scene.dimension, scene);
  settle_drift(scene);
  check_method(top, scene.settings);
  check_accuracy(top);
}

std::vector<std::string> integrator_choices() {
  std::vector<std::string> names = names_of(integrators);
  names.emplace_back(picked_integrator);
  return names;
}

void name_integrator(Scene& scene, const std::string& name) {
  scene.names_integrator = name != picked_integrator;
  scene.settings.integrator = scene.names_integrator ? method_called(integrators, name) : Settings{}.integrator;
}

std::string listed(const std::vector<std::string>& choices) {
  const std::span most(choices.data(), choices.size() - 1);
  return fmt::format("{} or {}", fmt::join(most, ", "), choices.back());
}

KeyTable keys_of_the_top() { return table_of("The top of the file", top_keys); }

}  // namespace cdot
