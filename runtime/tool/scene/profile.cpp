#include "runtime/tool/scene/profile.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "runtime/tool/scene/csv.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// clang-format off
constexpr struct { const char* name; Interpolation interpolation; } interpolations[] = {
    {"linear", Interpolation::linear}, {"step", Interpolation::step}, {"cubic", Interpolation::cubic}};
constexpr struct { const char* name; Beyond beyond; } ends[] = {
    {"hold", Beyond::hold}, {"repeat", Beyond::repeat}};
// clang-format on

std::string range_of(const NumberNeed& need) {
  if (std::isinf(need.below)) return fmt::format("above {:.6g}", need.above);
  if (std::isinf(need.above)) return fmt::format("below {:.6g}", need.below);
  return fmt::format("between {:.6g} and {:.6g}", need.above, need.below);
}

bool are_equal(const Profile& a, const Profile& b, const std::vector<double>& times) {
  return std::ranges::all_of(times, [&](double time) {
    const ProfileValue one = a.at(time), other = b.at(time);
    return one.value == other.value && one.rate == other.rate;
  });
}

// Those of its rows, and between; of an expression some.
std::vector<double> times_of(const WrittenProfile& written) {
  std::vector<double> times = written.table.times;
  for (std::size_t k = 0; k + 1 < written.table.times.size(); ++k) times.push_back((times[k] + times[k + 1]) / 2);
  for (int k = 0; k <= 100; ++k) times.push_back(0.1 * k);
  return times;
}

SceneNumber noted(Scene& scene, WrittenProfile written) {
  const Profile profile = written.profile;
  if (!written_profile(scene, profile)) scene.profiles.push_back(std::move(written));
  return {0, profile};
}

// A function may leave its range in a run: a mistake, with the first time at which it does.
bool keeps_range(const Entry& entry, Span where, const std::string& key, const Profile& profile,
                 const NumberNeed& need) {
  constexpr int samples = 1000;
  for (int k = 0; k <= samples; ++k) {
    const double time = need.scene->duration * k / samples, value = profile.at(time).value;
    if (need.above < value && value < need.below) continue;
    if (std::isfinite(value))
      entry.error(where, fmt::format("`{}` is {:.6g} at {:.6g} s: it must be {}", key, value, time, range_of(need)));
    else entry.error(where, fmt::format("`{}` has no value at {:.6g} s", key, time));
    return false;
  }
  return true;
}

std::optional<SceneNumber> read_expression(const Entry& entry, const std::string& key, const Entry::Written& written,
                                           const NumberNeed& need) {
  FormulaInTime::Reading read = FormulaInTime::read(written.text, need.unit);
  for (const FormulaMistake& mistake : read.mistakes)
    entry.error(place_in(written.where, written.text, mistake), mistake.cause, mistake.fix);
  if (!read.formula) return {};
  const Profile profile = Profile::function([formula = *read.formula](double time) {
    const auto [value, rate, acceleration] = formula.at(time);
    return ProfileValue{value, rate, acceleration};
  });
  if (!keeps_range(entry, written.where, key, profile, need)) return {};
  if (read.formula->constant()) return SceneNumber{profile.at(0).value};
  return noted(*need.scene, {profile, written.text, std::string(need.unit), {}});
}

template <class Rows>
std::vector<std::string> names_in(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

template <class Rows>
const auto& row_named(const Rows& rows, const std::string& name) {
  return *std::ranges::find(rows, name, [](const auto& row) { return std::string(row.name); });
}

// { table = "profile.csv", column = "thrust", interpolate = "linear", beyond = "hold" }
std::optional<SceneNumber> read_table_of_numbers(Entry& table, const std::string& key, const NumberNeed& need) {
  table.required("table", "{ table = \"profile.csv\", column = \"F\" }");
  table.required("column", fmt::format("column = \"{}\", the head of a column", key));
  const auto file = table.text("table"), column = table.text("column");
  const auto time = table.has("time") ? table.text("time") : std::optional<std::string>("time");
  const auto interpolate = table.has("interpolate") ? table.choice("interpolate", names_in(interpolations))
                                                    : std::optional<std::string>("linear");
  const auto beyond = table.has("beyond") ? table.choice("beyond", names_in(ends)) : std::optional<std::string>("hold");
  table.close();
  if (!file || !column || !time || !interpolate || !beyond) return {};
  try {
    const Csv csv = read_csv(table.beside(*file));
    const ProfileTable rows{.times = csv.column(*time, "s"),
                            .values = csv.column(*column, need.unit),
                            .interpolation = row_named(interpolations, *interpolate).interpolation,
                            .beyond = row_named(ends, *beyond).beyond};
    const Profile profile = Profile::table(rows);
    if (!keeps_range(table, table.where("table"), key, profile, need)) return {};
    return noted(*need.scene, {profile, {}, {}, rows});
  } catch (const Error& error) {
    table.error(table.where("table"), fmt::format("table \"{}\" of `{}`: {}", *file, key, error.what()));
    return {};
  }
}

}  // namespace

// A World keeps copies of its profiles, so the values tell.
const WrittenProfile* written_profile(const Scene& scene, const Profile& profile) {
  const auto found = std::ranges::find_if(scene.profiles, [&](const WrittenProfile& one) {
    return one.profile.hash() == profile.hash() && are_equal(profile, one.profile, times_of(one));
  });
  return found == scene.profiles.end() ? nullptr : &*found;
}

Span place_in(Span whole, const std::string& text, const FormulaMistake& mistake) {
  if (whole.end - whole.begin != static_cast<int>(text.size()) + 2) return whole;
  return {whole.line, whole.begin + 1 + mistake.begin, whole.begin + 1 + std::max(mistake.end, mistake.begin + 1)};
}

std::optional<std::vector<SceneNumber>> read_numbers_in_time(Entry& entry, const std::string& key,
                                                             std::optional<std::size_t> size, Quantity quantity,
                                                             const NumberNeed& need) {
  const auto written = entry.written_numbers(key, size, quantity);
  if (!written) return {};
  std::vector<SceneNumber> numbers;
  for (const Entry::Written& one : *written) {
    std::optional<SceneNumber> number;
    if (one.number) number = SceneNumber{*one.number};
    else if (one.table) {
      Entry table = entry.at(one);
      number = read_table_of_numbers(table, key, need);
    } else number = read_expression(entry, key, one, need);
    if (!number) return {};
    numbers.push_back(std::move(*number));
  }
  return numbers;
}

NamedValue named_value(std::string name, const std::vector<SceneNumber>& numbers) {
  NamedValue value{std::move(name), {}};
  for (const SceneNumber& number : numbers) {
    if (number.profile) value.in_time.push_back({static_cast<int>(value.numbers.size()), *number.profile});
    value.numbers.push_back(number.value);
  }
  return value;
}

}  // namespace cdot
