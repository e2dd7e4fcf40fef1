// Tables and data of a measurement.
#include "tests/bench/peers/report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace cdot::peers {
namespace {

// The cheapest point of an engine whose error is at most `level`; nullptr if it has none.
const Point* cheapest(const std::vector<Point>& points, const std::string& engine, double level) {
  for (const std::size_t k : frontier(points, engine))
    if (points[k].error <= level) return &points[k];
  return nullptr;
}

const Point* most_accurate(const std::vector<Point>& points, const std::string& engine) {
  const std::vector<std::size_t> best = frontier(points, engine);
  return best.empty() ? nullptr : &points[best.back()];
}

std::string short_number(double x) {
  if (x >= 1000) return fmt::format("{:.0f}", x);
  if (x >= 100) return fmt::format("{:.0f}", x);
  return x >= 10 ? fmt::format("{:.1f}", x) : fmt::format("{:.2f}", x);
}

std::string setting(const Point& point) { return fmt::format("{}, {}", point.series.name, knob_text(point)); }

std::string row_of(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += fmt::format(" {} |", cell);
  return row + "\n";
}

std::string header_of(const std::vector<std::string>& cells) {
  std::string rule = "|";
  for (std::size_t k = 0; k < cells.size(); ++k) rule += "---|";
  return row_of(cells) + rule + "\n";
}

// Price at each level with its ratio to Cdot's, and the settings.
std::string levels_table(const Measured& m) {
  const std::vector<std::string> names = present(m.points);
  std::vector<std::string> head{"error"};
  head.insert(head.end(), names.begin(), names.end());
  std::string prices = header_of(head), settings = header_of(head);
  for (int digits = 1; digits <= 9; ++digits) {
    const double level = std::pow(10.0, -digits);
    std::vector<std::string> cells{fmt::format("1e-{}", digits)}, how = cells;
    const Point* ours = cheapest(m.points, "Cdot", level);
    for (const std::string& name : names) {
      const Point* point = cheapest(m.points, name, level);
      cells.push_back("–");
      how.push_back("–");
      if (point == nullptr) continue;
      cells.back() = short_number(price(m.problem, *point));
      if (ours != nullptr && point != ours)
        cells.back() += fmt::format(" ({}×)", short_number(cost(*point) / cost(*ours)));
      how.back() = fmt::format("{} → {:.1e}", setting(*point), point->error);
    }
    prices += row_of(cells);
    settings += row_of(how);
  }
  return prices + "\n<details><summary>By what settings, and the error of each</summary>\n\n" + settings +
         "\n</details>\n";
}

// The cheapest engine besides Cdot at one level, and its price relative to Cdot's.
std::string rival(const Measured& m, double level) {
  const Point *ours = cheapest(m.points, "Cdot", level), *best = nullptr;
  for (const std::string& name : present(m.points)) {
    const Point* point = name.starts_with("Cdot") ? nullptr : cheapest(m.points, name, level);
    if (point == nullptr || point->engine->is_limit) continue;
    if (best == nullptr || cost(*point) < cost(*best)) best = point;
  }
  if (best == nullptr) return ours == nullptr ? "–" : "only Cdot";
  if (ours == nullptr) return "only " + best->engine->name;
  return fmt::format("{}× {}", short_number(cost(*best) / cost(*ours)), best->engine->name);
}

std::string summary(const std::vector<Measured>& all) {
  std::vector<std::string> head{"error"};
  for (const Measured& m : all) head.push_back(m.problem.title);
  std::string table = header_of(head);
  for (int digits = 1; digits <= 9; ++digits) {
    std::vector<std::string> cells{fmt::format("1e-{}", digits)};
    for (const Measured& m : all) cells.push_back(rival(m, std::pow(10.0, -digits)));
    table += row_of(cells);
  }
  return table;
}

// How far a knob is from the default: steps from 1/60 s, accuracies of adaptive methods from 1e-3.
double off_default(const Point& point) {
  return std::abs(std::log(point.knob / (point.series.knob == "h" ? 1.0 / 60 : 1e-3)));
}

// The point of an engine with no changed default, or with its first series if none is without; nullptr if it has none.
const Point* by_default(const std::vector<Point>& points, const std::string& engine) {
  const auto is_plain = [](const Point& point) { return point.series.changed.empty(); };
  const Point* found = nullptr;
  for (const Point& point : points) {
    if (point.engine->name != engine) continue;
    const bool same = found != nullptr && found->series.name == point.series.name;
    const bool plainer = found == nullptr || (is_plain(point) && !is_plain(*found));
    if (plainer || (same && off_default(point) < off_default(*found))) found = &point;
  }
  return found;
}

// The error of each engine with its defaults, and its price.
std::string defaults_table(const std::vector<Measured>& all) {
  std::vector<std::string> head{"engine"};
  for (const Measured& m : all) head.push_back(m.problem.title);
  std::string table = header_of(head);
  for (const Engine& engine : engines()) {
    std::vector<std::string> cells{engine.name};
    for (const Measured& m : all) {
      const Point* point = by_default(m.points, engine.name);
      cells.push_back("–");
      if (point == nullptr) continue;
      const std::string error = std::isfinite(point->error) ? fmt::format("{:.1e}", point->error) : "not finite";
      cells.back() = fmt::format("{}, {} µs ({})", error, short_number(price(m.problem, *point)), knob_text(*point));
    }
    table += row_of(cells);
  }
  return table;
}

// The smallest error of each engine, which shows that it solves the same problem.
std::string answers_table(const Measured& m) {
  std::string table = header_of({"engine", "smallest error", "by", "µs per simulated second"});
  for (const std::string& name : present(m.points)) {
    const Point* best = most_accurate(m.points, name);
    if (best == nullptr) {
      table += row_of({name, "none of its runs stays finite", "", ""});
      continue;
    }
    const std::string verdict = best->error < 1e-2 ? "" : " **does not converge to the reference**";
    table += row_of(
        {name, fmt::format("{:.1e}{}", best->error, verdict), setting(*best), short_number(price(m.problem, *best))});
  }
  return table;
}

std::string engines_table(const std::vector<Measured>& all) {
  std::string table = header_of({"engine", "version", "numbers", "changed defaults of all runs"});
  std::string series = header_of({"engine", "series", "its changed defaults"});
  std::set<std::string> seen;
  for (const Engine& engine : engines()) {
    bool any = false;
    for (const Measured& m : all) {
      for (const Point& point : m.points) {
        if (point.engine != &engine) continue;
        any = true;
        const std::string& name = point.series.name;
        if (!seen.insert(engine.name + "/" + name).second) continue;
        series += row_of({engine.name, name, point.series.changed});
      }
    }
    if (any) table += row_of({engine.name, engine.version, engine.number, engine.changed});
  }
  return table + "\n<details><summary>Every series that was swept</summary>\n\n" + series + "\n</details>\n";
}

std::string noise_text(const std::vector<Measured>& all) {
  std::vector<double> spreads;
  for (const Measured& m : all)
    for (const Point& point : m.points)
      if (point.seconds.size() > 1) spreads.push_back(spread(point));
  const std::vector<double>& beats = metronome();
  if (spreads.empty() || beats.empty()) return "";
  const double beat = median(beats);
  return fmt::format(
      "Noise: the same arithmetic, run {} times between the runs, took {:.2f} ms in the median, "
      "{:.2f} in the fastest and {:.2f} in the slowest tenth. Half the middle half of the rounds "
      "of one setting is {:.1f} % of its median for the median setting, {:.1f} % for the worst "
      "tenth.\n",
      beats.size(), 1e3 * beat, 1e3 * quantile(beats, 0.1), 1e3 * quantile(beats, 0.9), 100 * median(spreads),
      100 * quantile(spreads, 0.9));
}

std::string page(const std::string& command, const Options& options, const std::vector<Measured>& all) {
  std::string text = fmt::format(
      "# The cost of accuracy, here and elsewhere\n\n"
      "Written by `{}`.\n\n"
      "Microseconds of CPU time (one thread) per simulated second, for the cheapest setting of each "
      "engine whose error stays below the level; in brackets its ratio to Cdot's cheapest. The error "
      "is the largest over all bodies and four times, of the centre's distance [m] from the reference "
      "(of the angle [rad] for the torque-free body). Medians of {} interleaved rounds; `–`: no "
      "setting reaches it within {} s of CPU time for a run.\n\n{}\n",
      command, options.rounds, options.longest, noise_text(all));
  text += "## The cheapest of the others, against Cdot\n\nAbove 1×: Cdot is cheaper.\n\n" + summary(all) +
          "\n## With defaults\n\nThe error and the price of each engine with its defaults, at the step nearest "
          "1/60 s or at the accuracy 1e-3. Cdot chooses its method for the scene and the step.\n\n" +
          defaults_table(all) + "\n## The engines\n\n" + engines_table(all);
  for (const Measured& m : all) {
    text += fmt::format("\n## {}\n\n`specs/scenes/{}.toml`, {} s.\n\n![{}]({}.svg)\n\n{}\n{}", m.problem.title,
                        m.problem.scene, m.problem.duration, m.problem.title, m.problem.name, levels_table(m),
                        answers_table(m));
  }
  return text;
}

std::string csv(const std::vector<Measured>& all) {
  std::string text = "problem,engine,series,knob,value,error,us_per_simulated_second,spread,rounds\n";
  for (const Measured& m : all)
    for (const Point& p : m.points)
      text += fmt::format("{},{},\"{}\",{},{},{:.3e},{:.4g},{:.3f},{}\n", m.problem.name, p.engine->name, p.series.name,
                          p.series.knob, p.knob, p.error, price(m.problem, p), spread(p), p.seconds.size());
  return text;
}

// The frontier of every engine, one point a line.
std::string json(const std::vector<Measured>& all) {
  nlohmann::ordered_json entry;
  std::string text = "{";
  for (const Measured& m : all) {
    text += fmt::format("{}\n\"{}\": [", &m == &all.front() ? "" : ",", m.problem.name);
    const char* separator = "";
    for (const std::string& name : present(m.points)) {
      for (const std::size_t k : frontier(m.points, name)) {
        const Point& p = m.points[k];
        entry = {{"engine", name},
                 {"series", p.series.name},
                 {p.series.knob, p.knob},
                 {"error", p.error},
                 {"us_per_simulated_second", price(m.problem, p)},
                 {"spread", spread(p)},
                 {"rounds", p.seconds.size()}};
        text += fmt::format("{}\n{}", separator, entry.dump());
        separator = ",";
      }
    }
    text += "]";
  }
  return text + "\n}\n";
}

}  // namespace

std::string knob_text(const Point& point) {
  if (point.series.knob != "h") return fmt::format("{} {:.0e}", point.series.knob, point.knob);
  return fmt::format("1/{:.0f} s", 1 / point.knob);
}

double price(const Problem& problem, const Point& point) { return 1e6 * cost(point) / problem.duration; }

std::vector<std::string> present(const std::vector<Point>& points) {
  std::vector<std::string> names;
  for (const Engine& engine : engines())
    if (std::any_of(points.begin(), points.end(), [&](const Point& point) { return point.engine == &engine; }))
      names.push_back(engine.name);
  return names;
}

void write_report(const std::string& folder, const std::string& command, const Options& options,
                  const std::vector<Measured>& all) {
  std::ofstream(folder + "/README.md") << page(command, options, all);
  std::ofstream(folder + "/points.csv") << csv(all);
  std::ofstream(folder + "/frontiers.json") << json(all);
  for (const Measured& m : all) std::ofstream(folder + "/" + m.problem.name + ".svg") << picture(m);
}

}  // namespace cdot::peers
