// Changes the constants of an effect of a running World.
#include "runtime/effects/effect.hpp"

#include <fmt/format.h>

#include "runtime/balance/balance.hpp"
#include "runtime/world/islands.hpp"

namespace cdot {

template <class S>
Batch<S>* batch_of_effect(BasicWorld<S>& world, int joint, int effect, const NamedLaw<S>& named) {
  WorldData<S>& data = world.data();
  check_joint(data, joint);
  const JointRecord& record = data.joints[joint];
  if (record.places.empty()) return nullptr;
  const auto place = static_cast<size_t>(effect);
  if (effect < 1 || place >= record.places.size())
    throw Error(fmt::format("joint number {} has no effect number {}", joint, effect));
  Batch<S>& batch = *data.batches[record.places[place].batch];
  if (batch.law != &named.law)
    throw Error(fmt::format("effect number {} of joint number {} is not a {}", effect, joint, named.name));
  return &batch;
}

template <class S>
void set_constants(BasicWorld<S>& world, int joint, int effect, const NamedLaw<S>& named,
                   std::span<const double> constants) {
  WorldData<S>& data = world.data();
  Batch<S>* const batch = batch_of_effect(world, joint, effect, named);
  if (!batch) return;
  const JointRecord& record = data.joints[joint];
  if (named.law.energy) note_change(data);
  const auto count = static_cast<size_t>(named.law.constants);
  for (size_t k = 0; k < count; ++k)
    batch->constants[slot_of(data, record.places[static_cast<size_t>(effect)]) * count + k] =
        typename S::Scalar(constants[k]);
  const int body = movable_body(data, record);
  if (named.law.error)  // the law concerns positions
    wake(data, body);
  else wake_pushed(data, body);
}

#define CDOT_INSTANTIATE(S)                                                         \
  template Batch<S>* batch_of_effect(BasicWorld<S>&, int, int, const NamedLaw<S>&); \
  template void set_constants(BasicWorld<S>&, int, int, const NamedLaw<S>&, std::span<const double>);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
