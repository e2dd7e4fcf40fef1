// The shares of a BalanceWatch -> words.
#include "runtime/tool/run/balance_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace cdot {
namespace {

// Of what fails a run: a warning comes at this share, a failure by energy that rises without a source too.
constexpr double small_share = 0.1;

std::string percent(double share) {
  if (!std::isfinite(share)) return "all";
  return share < 0.1 ? fmt::format("{:.2g} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

// The account that is most above its limit.
struct Wrong {
  double excess = 1;
  std::string what;
  void take(double share, double limit, const std::string& words) {
    if (share / limit > excess) excess = share / limit, what = words;
  }
};

// "; fastest at t = 1.2 s, where the largest force was the 530 N of "joint3""
std::string fastest(const Scene& scene, const WorstStep& step) {
  const auto [joint, force] = step.largest;
  if (joint < 0) return {};
  return fmt::format("; fastest at t = {:.6g} s, where the largest force was the {:.3g} N of {}", step.time, force,
                     joint_name(scene, joint));
}

std::string energy_words(const Scene& scene, const RunResult& result, const BalanceWatch::Worst& worst) {
  return fmt::format("the method {} {:.3g} J, {} of the motion's {:.3g} J, by t = {:.6g} s{}",
                     worst.amount < 0 ? "lost" : "made up", std::abs(worst.amount), percent(worst.share()), worst.scale,
                     worst.time, fastest(scene, result.worst_step));
}

std::string momentum_words(const Scene& scene, const BalanceWatch::Worst& worst, const char* what, const char* unit) {
  return fmt::format("the method changed the {} of the bodies with {} by {:.3g} {}, {} of its size, by t = {:.6g} s",
                     what, body_name(scene, worst.body), worst.amount, unit, percent(worst.share()), worst.time);
}

Wrong wrong_with(const Scene& scene, const RunResult& result, double limit) {
  const BalanceWatch& seen = result.balance;
  Wrong wrong;
  wrong.take(seen.energy.share(), limit, energy_words(scene, result, seen.energy));
  wrong.take(seen.linear.share(), limit, momentum_words(scene, seen.linear, "momentum", "kg m/s"));
  wrong.take(seen.angular.share(), limit, momentum_words(scene, seen.angular, "angular momentum", "kg m^2/s"));
  return wrong;
}

// Where a motor presses bodies against an end in a pose that gives it any leverage, their work may exceed the motion's
// energy by far. Then a small share of it is more than the balance may miss.
std::string hidden_words(const RunResult& result) {
  const BalanceWatch& seen = result.balance;
  const WorstStep& step = result.worst_step;
  if (!(std::abs(step.most) > seen.of_motion())) return {};
  return fmt::format("the method {} {:.3g} J in the step to t = {:.6g} s, {:.3g} times the energy of the motion",
                     step.most < 0 ? "lost" : "made up", std::abs(step.most), step.most_time,
                     std::abs(step.most) / seen.of_motion());
}

std::string if_any(const BalanceWatch::Worst& worst, const char* what) {
  if (worst.scale == 0) return {};
  return fmt::format("{} within {:.2g} of its size", what, worst.share());
}

// "  work            motor 12.1 J, friction -3.9 J"
std::string work_text(const std::vector<WorkOfSource>& sources) {
  std::string text;
  for (const auto& [name, work] : sources) text += fmt::format("{}{} {:.6g} J", text.empty() ? "" : ", ", name, work);
  return text.empty() ? text : "  work            " + text + "\n";
}

text::Json json_of(const BalanceWatch::Worst& worst) {
  return {{"error", worst.amount}, {"scale", worst.scale}, {"time", worst.time}};
}

}  // namespace

double told_share(const Scene& scene) { return small_share * scene.energy_tolerance; }

double worst_share(const BalanceWatch& seen) {
  return std::max({seen.energy.share(), seen.linear.share(), seen.angular.share()});
}

std::string balance_failure(const Scene& scene, const RunResult& result) {
  Wrong wrong = wrong_with(scene, result, scene.energy_tolerance);
  const BalanceWatch::Worst& risen = result.balance.risen;
  wrong.take(risen.share(), told_share(scene), energy_words(scene, result, risen));
  return wrong.what;
}

std::string balance_warning(const Scene& scene, const RunResult& result) {
  if (!balance_failure(scene, result).empty()) return {};
  const std::string wrong = wrong_with(scene, result, told_share(scene)).what;
  return wrong.empty() ? hidden_words(result) : wrong;
}

std::string balance_text(const RunResult& result) {
  const BalanceWatch& seen = result.balance;
  std::string text = fmt::format(
      "  balance         {:.6g} J put in, {:.6g} J taken; the method's own at most {:.3g} J ({}), at t = {:.6g} s\n",
      seen.last.put_in, seen.last.taken, seen.energy.amount, percent(seen.energy.share()), seen.energy.time);
  text += work_text(result.work);
  const std::string linear = if_any(seen.linear, "linear"), angular = if_any(seen.angular, "angular");
  if (!linear.empty() || !angular.empty())
    text += fmt::format("  momentum        {}{}{}\n", linear, linear.empty() || angular.empty() ? "" : ", ", angular);
  return text;
}

text::Json balance_json(const RunResult& result) {
  const BalanceWatch& seen = result.balance;
  text::Json json = {{"put_in", seen.last.put_in}, {"taken", seen.last.taken}, {"method", json_of(seen.energy)}};
  json["work"] = text::Json::object();
  for (const auto& [name, work] : result.work) json["work"][std::string(name)] = work;
  if (seen.linear.scale > 0) json["momentum"] = json_of(seen.linear);
  if (seen.angular.scale > 0) json["angular_momentum"] = json_of(seen.angular);
  return json;
}

}  // namespace cdot
