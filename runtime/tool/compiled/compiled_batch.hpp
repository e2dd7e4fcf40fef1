// Many variants of one scene in lockstep: compiled steps with a variant in each lane, on all cores.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/tool/compiled/step_library.hpp"

namespace cdot {

class CompiledBatch {
 public:
  // All variants at the start of the scene. Throws Error if the scene cannot be compiled, with the fix.
  CompiledBatch(const Scene& scene, int variants, const StepWishes& wishes, const SceneCompiler& compiler);

  int variants() const { return variants_; }
  const std::vector<std::string>& bodies() const { return bodies_; }  // those that move
  const std::vector<std::string>& inputs() const { return inputs_; }
  int numbers_of_body() const { return numbers_; }  // state_columns()
  double time() const { return time_; }             // [s]
  double usual_step() const { return usual_step_; }

  // Steps of h [s] on so many threads. Throws Error if a variant has no numbers any more; the others go on.
  void step(double h, int count, int threads);

  // [variant][body][number], after which the variants are made whole, C = 0.
  void read(double* states) const;
  void write(const double* states);
  // Of an input, by its number.
  void set_input(int input, const double* values);
  // Energies [J] and the largest |C| [m], [rad] of the variants.
  void measure(double* energies, double* C) const;

 private:
  struct Pack {
    std::unique_ptr<void, void (*)(void*)> state;
    int first, count;  // of its variants; further lanes repeat the last one
  };
  template <class F>
  void each_lane(F f) const;
  void begin();
  void check() const;

  CompiledStep step_;
  std::vector<Pack> packs_;
  std::vector<std::string> bodies_, inputs_;
  int variants_, numbers_;
  double time_ = 0, usual_step_;
};

}  // namespace cdot
