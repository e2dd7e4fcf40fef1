// Tables and functions of time.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>

#include <cdot/kernel.hpp>
#include <cdot/profile.hpp>
#include <cdot/settings.hpp>

#include "runtime/rows/spline.hpp"

namespace cdot {

class Profile::Course {
 public:
  virtual ~Course() = default;
  virtual ProfileValue at(double time, const ProfileSpan& span) const = 0;
  virtual double next_break(double, int) const { return unbounded; }
  virtual std::array<double, 2> range() const { return {-unbounded, unbounded}; }
};

namespace {

class Constant final : public Profile::Course {
 public:
  explicit Constant(double value) : value_(value) {}
  ProfileValue at(double, const ProfileSpan&) const override { return {value_, 0, 0}; }
  std::array<double, 2> range() const override { return {value_, value_}; }

 private:
  double value_;
};

class Function final : public Profile::Course {
 public:
  explicit Function(std::function<ProfileValue(double)> of) : of_(std::move(of)) {}
  ProfileValue at(double time, const ProfileSpan&) const override { return of_(time); }

 private:
  std::function<ProfileValue(double)> of_;
};

// Pieces between rows, each a cubic of the time since its first row. The pieces before the first and after the last row
// are constant, or copies of the others a period away.
class Table final : public Profile::Course {
 public:
  explicit Table(ProfileTable table) : table_(std::move(table)), pieces_(pieces_of(table_)) {
    order_ = table_.interpolation == Interpolation::step ? 0 : table_.interpolation == Interpolation::linear ? 1 : 3;
    const bool equal = table_.values.front() == table_.values.back();
    order_of_ends_ = table_.beyond == Beyond::hold ? std::min(order_, 1) : equal ? order_ : 0;
    for (std::size_t order = 0; order < breaks_.size(); ++order)
      for (auto row = table_.times.cbegin(); row != table_.times.cend(); ++row)
        if (order_at(row) <= static_cast<int>(order)) breaks_[order].push_back(*row);
  }

  ProfileValue at(double time, const ProfileSpan& span) const override {
    // A time at which the piece of `time` holds, inside the span.
    const double inside = std::clamp(time, span.from, std::max(span.from, just_before(span)));
    const double shift = table_.beyond == Beyond::repeat ? periods_before(inside) * period() : 0;
    const auto next = std::upper_bound(table_.times.begin(), table_.times.end(), inside - shift);
    if (next == table_.times.begin()) return {table_.values.front(), 0, 0};
    const auto row = static_cast<std::size_t>(next - table_.times.begin()) - 1;
    if (row + 1 == table_.times.size()) return {table_.values.back(), 0, 0};
    const double t = time - shift - table_.times[row];
    const auto& [a, b, c, d] = pieces_[row];
    return {a + t * (b + t * (c + t * d)), b + t * (2 * c + t * 3 * d), 2 * c + t * 6 * d};
  }

  double next_break(double after, int order) const override {
    const std::vector<double>& breaks = breaks_[static_cast<std::size_t>(std::clamp(order, 0, 3))];
    const bool repeats = table_.beyond == Beyond::repeat;
    for (double shift = repeats ? periods_before(after) * period() : 0; !breaks.empty(); shift += period()) {
      for (auto at = std::upper_bound(breaks.begin(), breaks.end(), after - shift); at != breaks.end(); ++at)
        if (*at + shift > after) return *at + shift;
      if (!repeats) break;
    }
    return unbounded;
  }

  std::array<double, 2> range() const override {
    const auto [least, most] = std::ranges::minmax_element(table_.values);
    return {*least, *most};
  }

 private:
  double period() const { return table_.times.back() - table_.times.front(); }
  double periods_before(double time) const { return std::floor((time - table_.times.front()) / period()); }

  static double just_before(const ProfileSpan& span) {
    if (!std::isfinite(span.until)) return span.until;
    const double length = std::isfinite(span.from) ? span.until - span.from : 1 + std::abs(span.until);
    return span.until - 1e-6 * length;
  }

  // Of the lowest derivative that jumps there.
  int order_at(std::vector<double>::const_iterator row) const {
    const bool first = row == table_.times.begin(), last = row + 1 == table_.times.end();
    if ((!last && *(row + 1) == *row) || (!first && *(row - 1) == *row)) return 0;
    return first || last ? order_of_ends_ : order_;
  }

  ProfileTable table_;
  std::vector<Cubic> pieces_;
  int order_, order_of_ends_;                  // of the derivatives that jump at the rows
  std::array<std::vector<double>, 4> breaks_;  // times at which a derivative of this order or a lower one jumps
};

void check(const ProfileTable& table) {
  const auto& times = table.times;
  if (times.size() != table.values.size())
    throw Error(fmt::format("a table has {} times and {} values; it needs as many", times.size(), table.values.size()));
  if (times.size() < 2) throw Error("a table needs two rows at least");
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k]) || !std::isfinite(table.values[k]))
      throw Error(fmt::format("row {} of a table is not finite", k + 1));
    if (k == 0) continue;
    if (times[k] < times[k - 1])
      throw Error(fmt::format("the time of row {} of a table, {:.6g} s, lies before {:.6g} s of the row above", k + 1,
                              times[k], times[k - 1]));
    if (times[k] > times[k - 1]) continue;
    if (table.interpolation != Interpolation::linear)
      throw Error(fmt::format("rows {} and {} of a table have the same time, {:.6g} s; only a linear table jumps", k,
                              k + 1, times[k]));
    if (k > 1 && times[k] == times[k - 2])
      throw Error(fmt::format("rows {} to {} of a table have the same time, {:.6g} s; a jump has two rows", k - 1,
                              k + 1, times[k]));
  }
  if (!(times.back() > times.front())) throw Error("a table needs two different times");
  if (table.beyond == Beyond::repeat && table.interpolation == Interpolation::cubic &&
      table.values.front() != table.values.back())
    throw Error(
        fmt::format("a cubic table that repeats begins with {:.6g} and ends with {:.6g}: its last row must "
                    "be the first one again",
                    table.values.front(), table.values.back()));
}

}  // namespace

Profile::Profile(double constant) : course_(std::make_shared<Constant>(constant)) {}

Profile Profile::table(ProfileTable table) {
  check(table);
  Profile profile;
  profile.course_ = std::make_shared<Table>(std::move(table));
  return profile;
}

Profile Profile::function(std::function<ProfileValue(double)> of) {
  if (!of) throw Error("a function of time is missing");
  Profile profile;
  profile.course_ = std::make_shared<Function>(std::move(of));
  return profile;
}

ProfileValue Profile::at(double time, const ProfileSpan& span) const { return course_->at(time, span); }
double Profile::next_break(double after, int order) const { return course_->next_break(after, order); }
double Profile::least() const { return course_->range()[0]; }
double Profile::most() const { return course_->range()[1]; }

std::uint64_t Profile::hash() const {
  std::uint64_t hash = 0;
  for (const double time : {0.0, 0.1, 0.37, 1.0, 2.3, 7.7, 31.0})
    hash = 31 * hash + std::bit_cast<std::uint64_t>(at(time).value);
  return hash;
}

}  // namespace cdot
