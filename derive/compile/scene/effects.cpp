#include "derive/compile/scene/effects.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include <cdot/effects.hpp>

#include "derive/compile/scene/bonds.hpp"
#include "derive/compile/scene/groups.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/rows/spline.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/tool/scene/profile.hpp"
#include "runtime/world/islands.hpp"

namespace cdot::compile {
namespace {

bool is_damper(const CoordinateSpring& spring) {
  return !spring.softness.by_frequency && spring.softness.stiffness == 0;
}

// order: steps end where a derivative of this order or a lower one jumps.
Table table_of(const ProfileTable& rows, int order) {
  Table table{rows.times, pieces_of(rows), rows.beyond == Beyond::repeat, {}};
  table.pieces.push_back({rows.values.back()});
  for (std::size_t k = 0; k + 1 < rows.times.size(); ++k)
    if (rows.times[k] == rows.times[k + 1]) table.pieces[k] = {rows.values[k]};  // a jump
  const Profile profile = Profile::table(rows);
  const double last = rows.times.back();
  for (double at = profile.next_break(rows.times.front() - 1e-9, order); at <= last; at = profile.next_break(at, order))
    table.breaks.push_back(at);
  return table;
}

template <class S>
class EffectReader {
 public:
  EffectReader(const Scene& scene, BasicWorld<S>& world, const RefuseEffect& refuse, Mechanism& mechanism)
      : scene_(scene), world_(world), refuse_(refuse), mechanism_(mechanism) {}

  void read() {
    const int joints = static_cast<int>(scene_.joints.size());
    for (int j = 0; j < joints; ++j) {
      const SceneJoint& source = scene_.joints[static_cast<std::size_t>(j)];
      if (record(j).places.empty()) continue;  // between immovable bodies
      if (!notes_parameters(source, j)) continue;
      if (world_.joint_type(j).is_effect) add_of_joint(source, j);
      else if (source.definition.soft) add_soft(source.name, j, is_rope(world_.joint_type(j)));
      else if (is_rope(world_.joint_type(j))) add_rope(source, j);
      add_on_coordinates(source, j);
    }
    parameters_in_time_.clear();
    for (int j = joints; j < world_.joint_count(); ++j)
      if (!record(j).places.empty()) add_soft(fmt::format("spring{}", j - joints + 1), j);
    const std::vector<int> groups = groups_of(mechanism_);
    for (Effect& motor : strong_motors_) add_strong_motor(motor, groups);
  }

 private:
  const JointRecord& record(int joint) { return world_.data().joints[static_cast<std::size_t>(joint)]; }
  const Batch<S>& batch_of(const Place& place) { return *world_.data().batches[static_cast<std::size_t>(place.batch)]; }
  bool is_bounded(const Place& place) { return batch_of(place).law && batch_of(place).law->guard; }
  bool has_limits(const Place& place) { return batch_of(place).law->within_limits != nullptr; }

  std::vector<double> constants_of(const Place& place) {
    const Batch<S>& batch = batch_of(place);
    const int count = batch.law->constants;
    const double* const first = batch.constants.data() + slot_of(world_.data(), place) * count;
    return {first, first + count};
  }

  // An effect that acts along the rows of the World's joint.
  Effect along(const std::string& name, int joint) {
    Effect effect;
    effect.name = name, effect.type = world_.joint_type(joint).name, effect.bodies = record(joint).bodies;
    const int ground = static_cast<int>(scene_.bodies.size());
    for (int& body : effect.bodies) body = body == world_.ground() ? ground : body;
    effect.parameters = world_.joint_parameters(joint), effect.parameters_in_time = parameters_in_time_;
    effect.holds = number_among_breakable(world_, joint);
    prepare_topology(world_.data());
    for (const int body : record(joint).bodies)
      if (const int number = world_.data().island_of[static_cast<std::size_t>(body)]; number >= 0) {
        const Island<S>& island = world_.data().islands[static_cast<std::size_t>(number)];
        effect.size = double(island.size), effect.beside_motor = has_unlimited_motor_beside_ends(island);
      }
    return effect;
  }

  // Of a rope or a soft joint. False if it is refused.
  bool notes_parameters(const SceneJoint& source, int joint) {
    parameters_in_time_.clear();
    if (!source.definition.soft && !is_rope(world_.joint_type(joint))) return true;
    const bool known = find_functions(scene_, record(joint), -1, true, mechanism_, parameters_in_time_);
    if (!known) refuse_(source, fmt::format("{}: numbers that follow a function of a program", source.name));
    return known;
  }

  // Places: its own rows, then those with bounds.
  void add_of_joint(const SceneJoint& source, int joint) {
    Effect effect = along(source.name, joint);
    effect.law_type = effect.type;
    effect.numbers = effect.parameters;
    if (!note_functions(source, joint, -1, effect)) return;
    const std::vector<Place>& places = record(joint).places;
    const auto rows = world_.joint_type(joint).row_names.size();
    if (rows > 0 && has_limits(places[0]) && mechanism_.method == Method::euler) {
      if (rows > 1) return refuse_(source, fmt::format("{}: several forces with limits", effect.type));
      effect.law = Effect::limited;
      mechanism_.bounded.push_back(effect);
    } else if (rows > 0) {
      mechanism_.effects.push_back(effect);
    }
    effect.law = Effect::bound;
    const std::size_t first = mechanism_.bounded.size();
    for (std::size_t k = 1; k < places.size() && is_bounded(places[k]); ++k, ++effect.row) {
      const auto& law = *batch_of(places[k]).law;
      effect.cone = law.cone_rows > 0 ? static_cast<int>(first + effect.row) - law.cone_row : -1;
      effect.loaded_by_row = -1;
      for (std::size_t other = 1; other < places.size(); ++other)
        if (batch_of(places[other]).law == law.load_of) effect.loaded_by_row = static_cast<int>(first + other - 1);
      add_bounded(source, effect, places[k]);
    }
  }

  void add_bounded(const SceneJoint& source, const Effect& effect, const Place& place) {
    const auto& law = *batch_of(place).law;
    if (law.by_load && !effect.is_loaded())
      refuse_(source, fmt::format("{}: bounds that grow with the load of a joint that is soft", effect.name));
    else {
      mechanism_.bounded.push_back(effect);
      mechanism_.bounded.back().by_own_force = law.distance && by_own_force(place);
    }
  }

  // True if an event of the row depends on the force that it carries.
  bool by_own_force(const Place& place) {
    using T = typename S::Scalar;
    const Batch<S>& batch = batch_of(place);
    T of_none[2], of_large[2];
    batch.law->distance(batch, slot_of(world_.data(), place), T(0), T(0), of_none);
    batch.law->distance(batch, slot_of(world_.data(), place), T(0), T(1e15), of_large);
    return !std::equal(of_none, of_none + 2, of_large);
  }

  // C >= 0
  void add_rope(const SceneJoint& source, int joint) {
    Effect effect = along(source.name, joint);
    effect.law = Effect::limit;
    effect.numbers = {0, std::numeric_limits<double>::infinity()};
    effect.tensions = tensions_of(world_, record(joint).places[0]);
    add_bounded(source, effect, record(joint).places[0]);
  }

  void add_soft(const std::string& name, int joint, bool pulls = false) {
    Effect effect = along(name, joint);
    effect.law = Effect::spring, effect.pulls = pulls;
    effect.numbers = constants_of(record(joint).places[0]);
    effect.numbers.push_back(0);  // C itself is the distance from rest
    if (counts_turns(world_, joint)) effect.turns = turns_of(world_.joint_type(joint), mechanism_);
    const bool has_bounds = pulls && mechanism_.method == Method::euler;
    (has_bounds ? mechanism_.bounded : mechanism_.effects).push_back(std::move(effect));
  }

  void add_on_coordinates(const SceneJoint& source, int joint) {
    std::size_t count = 0;
    for (const CoordinateEffects& on : source.effects) on.each([&](const auto&) { ++count; });
    const std::vector<Place>& places = record(joint).places;
    std::size_t next = places.size() - count;
    for (const CoordinateEffects& on : source.effects)
      on.each([&](const auto& effect) { add_on_coordinate(source, joint, on.coordinate, effect, next++); });
  }

  template <class Kind>
  void add_on_coordinate(const SceneJoint& source, int joint, const std::string& coordinate, const Kind& kind,
                         std::size_t number) {
    const Place place = record(joint).places[number];
    Effect effect = along(source.name + "." + coordinate, joint);
    effect.coordinate = coordinate;
    effect.numbers = constants_of(place);
    if (batch_of(place).law->by_load) effect.loaded_by_joint = joint_named(source.name);
    if (!note_functions(source, joint, static_cast<int>(number), effect)) return;
    const std::string what = name_law(kind, effect);
    if (effect.law == Effect::motor && mechanism_.on_accelerations() && std::isinf(effect.numbers[1]))
      return strong_motors_.push_back(effect);
    effect.name += "." + what;
    if (batch_of(place).ops->counters > 0) effect.angle = mechanism_.angles++;
    effect.tensions = tensions_of(world_, place);
    if (is_bounded(place)) return add_bounded(source, effect, place);
    if (has_limits(place) && mechanism_.method == Method::euler) {
      effect.law = Effect::limited;
      mechanism_.bounded.push_back(std::move(effect));
    } else {
      mechanism_.effects.push_back(std::move(effect));
    }
  }

  // Among those of the mechanism; -1: it is none of these.
  int joint_named(const std::string& name) const {
    const auto found = std::ranges::find(mechanism_.joints, name, &Joint::name);
    return found == mechanism_.joints.end() ? -1 : static_cast<int>(found - mechanism_.joints.begin());
  }

  // A motor without a largest force never slips, so it needs no events: it is an equation. In a mechanism with ends it
  // is the last of the rows with bounds: an end that is met stops it, as in the World.
  void add_strong_motor(Effect& effect, const std::vector<int>& groups) {
    const bool shared = std::ranges::any_of(mechanism_.bounded, [&](const Effect& other) {
      return (other.law == Effect::limit || other.law == Effect::bound) &&
             group_of(groups, other.bodies) == group_of(groups, effect.bodies);
    });
    if (shared) {
      effect.name += ".motor";
      mechanism_.bounded.push_back(effect);
      return;
    }
    mechanism_.joints.push_back(
        {effect.name + ".motor", effect.type, effect.bodies, effect.parameters, effect.coordinate, effect.numbers[0]});
    mechanism_.joints.back().holds = effect.holds;
    if (const auto speed = effect.in_time.find(0); speed != effect.in_time.end())
      mechanism_.joints.back().speed_in_time = speed->second;
  }

  // Among the rows of a place; -1: of the joint.
  bool has_ends(int joint, int place) {
    const std::vector<Place>& places = record(joint).places;
    const auto ends = [&](const Place& of) { return batch_of(of).law && batch_of(of).law->error; };
    return place < 0 ? std::ranges::any_of(places, ends) : ends(places[static_cast<std::size_t>(place)]);
  }

  // Notes which numbers follow functions of time. `place`: of its rows; -1: its own. False if it is refused.
  bool note_functions(const SceneJoint& source, int joint, int place, Effect& effect) {
    const bool moves = has_ends(joint, place);
    const bool known = find_functions(scene_, record(joint), place, moves, mechanism_, effect.in_time);
    if (!known) refuse_(source, fmt::format("{}: numbers that follow a function of a program", effect.name));
    return known;
  }

  // Of the effects that have a short form, the ones whose numbers follow functions of time are read as specs.
  std::string name_law(const SpecEffect& kind, Effect& effect) {
    if (kind.type == "motor") return name_law(Motor{}, effect);
    if (kind.type == "load") return name_law(Load{}, effect);
    if (kind.type == "limit") return name_limit(effect, false);
    if (kind.type == "friction") {
      std::map<std::size_t, InTime> in_time;
      for (const auto& [number, function] : effect.in_time) in_time[number + 1] = function;
      effect.in_time = std::move(in_time);
      return name_law(DryFriction{}, effect);
    }
    const JointType& type = *find_coordinate_effect(kind.type);
    effect.law = type.row_names.empty() ? Effect::bound : Effect::of_spec;
    return effect.law_type = kind.type;
  }
  // The numbers of coordinate::spring as those of soft joints: by frequency, which, damping, rest.
  static std::string name_law(const CoordinateSpring& kind, Effect& effect) {
    effect.law = Effect::spring;
    const Softness& soft = kind.softness;
    effect.numbers = {double(soft.by_frequency), soft.by_frequency ? soft.frequency : soft.stiffness,
                      soft.by_frequency ? soft.damping_ratio : soft.damping, effect.numbers.back()};
    return is_damper(kind) ? "damper" : "spring";
  }
  static std::string name_law(const Load&, Effect& effect) {
    effect.law = Effect::load;
    return "load";
  }
  static std::string name_law(const Motor&, Effect& effect) {
    effect.law = Effect::motor;
    return "motor";
  }
  static std::string name_law(const DryFriction&, Effect& effect) {
    effect.law = Effect::motor;
    effect.numbers.insert(effect.numbers.begin(), 0);  // the speed
    return "friction";
  }
  static std::string name_law(const Limit& kind, Effect& effect) {
    return name_limit(effect, kind.lower == kind.upper);
  }
  static std::string name_limit(Effect& effect, bool holds) {
    effect.law = holds ? Effect::lock : Effect::limit;
    return "limit";
  }

  const Scene& scene_;
  BasicWorld<S>& world_;
  const RefuseEffect& refuse_;
  Mechanism& mechanism_;
  std::map<std::size_t, InTime> parameters_in_time_;  // of the joint that is read
  std::vector<Effect> strong_motors_;
};

}  // namespace

bool find_functions(const Scene& scene, const JointRecord& record, int place, bool moves, Mechanism& mechanism,
                    std::map<std::size_t, InTime>& in_time) {
  const int order = mechanism.on_accelerations() ? 2 : moves ? 1 : 0;
  for (const auto& [of_place, drive] : record.drives) {
    if (of_place != place) continue;
    const WrittenProfile* const written = written_profile(scene, drive.profile);
    if (!written) return false;
    InTime& function = in_time[static_cast<std::size_t>(drive.number)];
    function = {written->text, written->unit};
    if (!written->text.empty()) continue;
    function.table = static_cast<int>(mechanism.tables.size());
    mechanism.tables.push_back(table_of(written->table, order));
  }
  return true;
}

bool is_rope(const JointType& type) { return type.row_kinds.size() == 1 && type.row_kinds[0] == RowKind::inequality; }

template <class S>
int tensions_of(BasicWorld<S>& world, const Place& place) {
  prepare_topology(world.data());
  for (const auto& island : world.data().islands)
    for (const auto& tension : island.system.tensions)
      if (tension.batch == world.data().batches[static_cast<std::size_t>(place.batch)].get() &&
          tension.slot == slot_of(world.data(), place))
        return tension.rows;
  return 0;
}

template <class S>
bool counts_turns(BasicWorld<S>& world, int joint) {
  const std::vector<Place>& places = world.data().joints[static_cast<std::size_t>(joint)].places;
  return !places.empty() && world.data().batches[static_cast<std::size_t>(places[0].batch)]->ops->counters > 0;
}

std::vector<CountedTurns> turns_of(const JointType& type, Mechanism& mechanism) {
  std::vector<CountedTurns> turns;
  for (const CoordinateInfo& coordinate : type.coordinates)
    for (const ParameterInfo& info : type.parameters)
      if (info.unit == "rad" && info.name == std::string(coordinate.name) + "_turns")
        turns.push_back({static_cast<std::size_t>(info.offset), std::string(coordinate.name), mechanism.angles++});
  return turns;
}

template <class S>
void read_effects(const Scene& scene, BasicWorld<S>& world, const RefuseEffect& refuse, Mechanism& mechanism) {
  EffectReader<S>(scene, world, refuse, mechanism).read();
}

#define CDOT_INSTANTIATE(S)                               \
  template int tensions_of(BasicWorld<S>&, const Place&); \
  template bool counts_turns(BasicWorld<S>&, int);        \
  template void read_effects(const Scene&, BasicWorld<S>&, const RefuseEffect&, Mechanism&);
CDOT_INSTANTIATE(Planar<double>)
CDOT_INSTANTIATE(Spatial<double>)
#undef CDOT_INSTANTIATE

}  // namespace cdot::compile
