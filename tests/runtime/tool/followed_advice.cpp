#include "tests/runtime/tool/followed_advice.hpp"

#include <cmath>
#include <fmt/format.h>

#include "runtime/tool/commands/command.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {

Ran simulated(const std::string& file, const std::string& options) {
  const CommandResult result = cdot_run(fmt::format("simulate '{}' {} --json", file, options));
  Ran ran{result.status, {}};
  if (!result.out.empty()) ran.summary = nlohmann::json::parse(result.out);
  return ran;
}

FollowedAdvice follow_advice(const std::string& file, const std::string& options) {
  const Ran first = simulated(file, options);
  if (first.summary.is_null())
    return {false, "", first.status == bad_input ? refused : fmt::format("no summary, exit {}", first.status)};
  const bool advised = first.summary.contains("advice");
  if (first.silent()) return {true, "", advised ? "advice without a need" : ""};
  if (!advised) return {false, "", "neither silent nor with advice\n" + first.summary.dump(2)};
  const auto& advice = first.summary["advice"];
  const std::string pasted = advice["options"];
  if (pasted.empty()) return {};
  const double until = advice["until"];
  const Ran second =
      simulated(file, fmt::format("{} {}{}", options, pasted, until > 0 ? fmt::format(" --until {}", until) : ""));
  if (!second.silent()) return {false, pasted, "is no cure: " + pasted + "\n" + second.summary.dump(2)};
  const auto& method = second.summary["balance"]["method"];
  const double energy = method["error"], scale = method["scale"], promised = advice["share"];
  if (!(std::abs(energy) <= (1.001 * promised + 1e-15) * scale))
    return {false, pasted,
            fmt::format("{} keeps the energy to {:.3g}, {:.3g} promised", pasted, energy / scale, promised)};
  const auto& own = second.summary.value("own_steps", nlohmann::json{{"evaluations", 0}});
  if (advice["steps"] != second.summary["steps"] || advice["evaluations"] != own["evaluations"])
    return {
        false, pasted,
        fmt::format("{} takes {} steps and {} evaluations, {} and {} promised", pasted, second.summary["steps"].dump(),
                    own["evaluations"].dump(), advice["steps"].dump(), advice["evaluations"].dump())};
  return {false, pasted, ""};
}

}  // namespace cdot::test
