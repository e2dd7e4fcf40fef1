#include "runtime/state/drives.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/spaces.hpp>

#include "runtime/rows/parameters.hpp"

namespace cdot {
namespace {

const ParameterInfo& info_of(const JointType& type, const NamedValue& value) {
  return *std::ranges::find(type.parameters, value.name, &ParameterInfo::name);
}

}  // namespace

#ifndef CDOT_EXTENDED
namespace {

std::string named(const JointType& type, const std::string& parameter) {
  return fmt::format("`{}` of {} `{}`", parameter, type.is_effect ? "effect" : "joint", type.name);
}

// The runtime writes it: `<coordinate>_turns` in radians (cdot/detail/turns.hpp).
bool counts_turns(const JointType& type, const ParameterInfo& info) {
  constexpr std::string_view ending = "_turns";
  if (info.unit != "rad" || !info.name.ends_with(ending)) return false;
  const std::string_view coordinate = info.name.substr(0, info.name.size() - ending.size());
  return std::ranges::count(type.coordinates, coordinate, &CoordinateInfo::name) > 0;
}

}  // namespace

std::vector<NamedValue> at_time(std::vector<NamedValue> given, double time) {
  for (NamedValue& value : given)
    for (const auto& [number, profile] : value.in_time) {
      if (number < 0 || number >= static_cast<int>(value.numbers.size()) || !profile)
        throw Error(fmt::format("parameter `{}` has {} numbers; number {} cannot follow a function of time", value.name,
                                value.numbers.size(), number));
      value.numbers[static_cast<std::size_t>(number)] = profile.at(time).value;
    }
  return given;
}

void refuse_functions(const std::vector<NamedValue>& given, const char* where) {
  for (const NamedValue& value : given)
    if (!value.in_time.empty())
      throw Error(
          fmt::format("{} takes constants, and `{}` is a function of time. Likely fix: give it when the joint "
                      "or the effect is added",
                      where, value.name));
}

void refuse_driven(const JointModel& joint, const JointType& type, int place, const std::vector<NamedValue>& given) {
  for (const NamedValue& value : given) {
    const auto info = std::ranges::find(type.parameters, value.name, &ParameterInfo::name);
    for (const JointDrive& drive : joint.drives)
      if (info != type.parameters.end() && drive.place == place && drive.drive.number >= info->offset &&
          drive.drive.number < info->offset + info->size)
        throw Error(fmt::format("{} follows a function of time and cannot be set", named(type, value.name)));
  }
}
void check_functions(const JointType& type, const std::vector<NamedValue>& given) {
  for (const NamedValue& value : given) {
    if (value.in_time.empty()) continue;
    const ParameterInfo& info = info_of(type, value);
    if (info.kind == ParameterKind::unit || info.kind == ParameterKind::frame)
      throw Error(
          fmt::format("{} is a direction of length 1 and cannot follow a function of time. Likely fix: fix it "
                      "on a body that turns",
                      named(type, value.name)));
    if (counts_turns(type, info))
      throw Error(fmt::format(
          "{} counts whole turns and cannot follow a function of time. Likely fix: another number of the joint does",
          named(type, value.name)));
    if (!type.is_effect && std::ranges::count(type.row_kinds, RowKind::velocity) > 0)
      throw Error(fmt::format("{} cannot follow a function of time: the joint has rows without a position",
                              named(type, value.name)));
    for (const auto& [number, profile] : value.in_time) {
      if (const double jump = profile.next_break(0, 0); !type.is_effect && std::isfinite(jump))
        throw Error(
            fmt::format("{} jumps at t = {:.6g} s, and bodies do not. Likely fix: a linear or cubic table, without two "
                        "rows of one time",
                        named(type, value.name), jump));
      if (open_end(info) < profile.least() || std::isinf(profile.least())) {
        if (profile.most() < info.below || std::isinf(profile.most())) continue;
      }
      throw Error(fmt::format("{} follows values from {:.6g} to {:.6g} [{}]. Likely fix: numbers{}",
                              named(type, value.name), profile.least(), profile.most(), info.unit, range_of(info)));
    }
  }
}
#endif

template <class S>
void add_drives(WorldData<S>& world, int joint, int place, const JointType& type,
                const std::vector<NamedValue>& given) {
  JointRecord& record = world.joints[static_cast<std::size_t>(joint)];
  for (const NamedValue& value : given) {
    const ParameterInfo& info = info_of(type, value);
    const bool in_world = info.kind == ParameterKind::point &&
                          (info.body < 0 || record.bodies[static_cast<std::size_t>(info.body)] == world.ground);
    for (const auto& [number, profile] : value.in_time) {
      const double offset = in_world ? -world.origin[static_cast<std::size_t>(number)] : 0;
      record.drives.push_back({place, {info.offset + number, place >= 0, profile, offset, open_end(info), info.below}});
      record.added.add(info.offset + number), record.added.add(profile.hash());
      world.driven = true, world.prepared = false;
    }
  }
}

#define CDOT_INSTANTIATE(S) \
  template void add_drives(WorldData<S>&, int, int, const JointType&, const std::vector<NamedValue>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
