#include "runtime/tool/compiled/compiled_batch.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <thread>

#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

std::vector<std::string> moving_bodies(const Scene& scene) {
  std::vector<std::string> names;
  in_space_of<double>(scene, [&]<class S>(S) {
    std::string warnings;
    const auto world = world_at_start<S>(scene, warnings);
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
      if (!world.is_static(static_cast<int>(body))) names.push_back(scene.bodies[body].name);
  });
  return names;
}

}  // namespace

CompiledBatch::CompiledBatch(const Scene& scene, int variants, const StepWishes& wishes, const SceneCompiler& compiler)
    : bodies_(moving_bodies(scene)),
      inputs_(wishes.inputs),
      variants_(variants),
      numbers_(static_cast<int>(state_columns(scene.dimension).size())),
      usual_step_(scene.step > 0 ? scene.step : 1e-3) {
  const LoadedSteps steps = load_steps(scene, wishes, compiler);
  if (!steps.failure.empty()) throw Error(fmt::format("the scene cannot be compiled: {}", steps.failure));
  step_ = variants == 1 ? steps.one : steps.many;
  for (int first = 0; first < variants; first += step_.lanes)
    packs_.push_back({{step_.make(), step_.destroy}, first, std::min(step_.lanes, variants - first)});
}

// f(pack, lane, variant) of all lanes.
template <class F>
void CompiledBatch::each_lane(F f) const {
  for (const Pack& pack : packs_)
    for (int lane = 0; lane < step_.lanes; ++lane) f(pack, lane, pack.first + std::min(lane, pack.count - 1));
}

void CompiledBatch::begin() {
  for (const Pack& pack : packs_) step_.begin(pack.state.get());
}

void CompiledBatch::step(double h, int count, int threads) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k; (k = next++) < packs_.size();) step_.advance(packs_[k].state.get(), h, count);
  };
  {
    std::vector<std::jthread> others;
    for (int k = 1; k < std::min(threads, static_cast<int>(packs_.size())); ++k) others.emplace_back(work);
    work();
  }
  time_ += h * count;
  check();
}

void CompiledBatch::check() const {
  each_lane([&](const Pack& pack, int lane, int variant) {
    double energy, C;
    step_.measure(pack.state.get(), lane, &energy, &C);
    if (!std::isfinite(energy) || !std::isfinite(C))
      throw Error(fmt::format(
          "variant {} of the batch: its state is not a number at {:.4g} s. Likely fix: shorter steps", variant, time_));
  });
}

void CompiledBatch::read(double* states) const {
  const auto size = static_cast<std::ptrdiff_t>(bodies_.size()) * numbers_;
  for (const Pack& pack : packs_)
    for (int lane = 0; lane < pack.count; ++lane, states += size) step_.read(pack.state.get(), lane, states);
}

void CompiledBatch::write(const double* states) {
  const auto size = static_cast<std::ptrdiff_t>(bodies_.size()) * numbers_;
  each_lane(
      [&](const Pack& pack, int lane, int variant) { step_.write(pack.state.get(), lane, states + variant * size); });
  begin();
}

void CompiledBatch::set_input(int input, const double* values) {
  each_lane([&](const Pack& pack, int lane, int variant) {
    step_.set_input(pack.state.get(), lane, input, values[variant]);
  });
  begin();
}

void CompiledBatch::measure(double* energies, double* C) const {
  for (const Pack& pack : packs_)
    for (int lane = 0; lane < pack.count; ++lane) step_.measure(pack.state.get(), lane, energies++, C++);
}

}  // namespace cdot
