// The top of a scene file: what is simulated, for how long, and how.
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// With a local error the step is only how often the run is looked at.
void read_time(Entry& top, Scene& scene) {
  scene.duration = top.number("duration", {Sign::positive}).value_or(scene.duration);
  const double step = top.has("local_error") ? scene.duration / 64 : scene.step;
  scene.step = top.number("step", {Sign::positive}).value_or(step);
  if (scene.step > scene.duration) {
    top.error(top.where("step"),
              fmt::format("the step of {} s is longer than the duration of {} s", scene.step, scene.duration));
  }
}

void read_method(Entry& top, Settings& settings) {
  if (const auto solver = top.choice("solver", names_of(solvers))) settings.solver = method_called(solvers, *solver);
  if (const auto integrator = top.choice("integrator", names_of(integrators)))
    settings.integrator = method_called(integrators, *integrator);
  if (const auto drift = top.choice("drift", names_of(drifts))) settings.drift = method_called(drifts, *drift);
  settings.local_error = top.number("local_error", {Sign::positive}).value_or(settings.local_error);
  if (const auto kernels = top.choice("kernels", names_of(kernel_forms)))
    settings.kernels = method_called(kernel_forms, *kernels);
  settings.iterations = top.whole("iterations", 1).value_or(settings.iterations);
  settings.substeps = top.whole("substeps", 1).value_or(settings.substeps);
  settings.baumgarte = top.number("baumgarte", {Sign::positive}).value_or(settings.baumgarte);
  settings.warm_start = top.flag("warm_start").value_or(settings.warm_start);
  if (const char* wrong = wrong_with_methods(settings))
    top.error(top.where(top.has("drift") ? "drift" : "local_error"), wrong);
  if (settings.baumgarte > 1) {
    top.error(top.where("baumgarte"), "`baumgarte` is the share of the error removed per step: at most 1");
  }
}

// An accuracy stands in the place of a method.
void read_accuracy(Entry& top, Scene& scene) {
  scene.accuracy = top.number("accuracy", {Sign::positive}).value_or(0);
  if (!top.has("accuracy")) return;
  for (const char* key :
       {"step", "solver", "integrator", "local_error", "drift", "substeps", "iterations", "kernels", "precision"})
    if (top.has(key))
      top.error(top.where(key), fmt::format("`accuracy` chooses the method: `{}` has no say beside it", key),
                fmt::format("leave out `{}`, or `accuracy`", key));
}

}  // namespace

void read_settings(Entry& top, Scene& scene) {
  scene.title = top.text("title").value_or("");
  const int dimension = top.whole("dimension", 2).value_or(2);
  if (dimension > 3) top.error(top.where("dimension"), "a scene is planar or in space", "dimension = 2 or 3");
  scene.dimension = dimension == 3 ? Dimension::spatial : Dimension::planar;
  const bool in_space = scene.dimension == Dimension::spatial;
  const Vec3 gravity =
      read_vector(top, "gravity", scene.dimension).value_or(in_space ? Vec3{0, 0, -9.81} : Vec3{0, -9.81, 0});
  scene.settings.gravity_x = gravity[0];
  scene.settings.gravity_y = gravity[1];
  scene.settings.gravity_z = gravity[2];
  read_time(top, scene);
  read_method(top, scene.settings);
  if (const auto precision = top.choice("precision", names_of(precisions)))
    scene.single = method_called(precisions, *precision);
  read_accuracy(top, scene);
  scene.settings.sleep_after = top.number("sleep_after", {Sign::not_negative}).value_or(0);
  scene.settings.sleep_speed = top.number("sleep_speed", {Sign::positive}).value_or(scene.settings.sleep_speed);
  scene.tolerance = top.number("tolerance", {Sign::positive}).value_or(scene.tolerance);
  scene.project = top.flag("project").value_or(false);
  if (const auto answer = top.choice("on_failure", names_of(failure_answers)))
    scene.on_failure = method_called(failure_answers, *answer);
}

}  // namespace cdot
