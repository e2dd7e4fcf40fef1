// Tasks in several processes at once. GiNaC has global state, so threads are impossible.
#pragma once

#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cdot::derive {

// The result of a task, or the reason for its failure ("killed by signal 9 (Killed)").
struct Answer {
  std::string result, failure;
};

struct Tasks {
  std::vector<std::string> names;                        // for people; as many as there are tasks
  std::vector<std::size_t> order;                        // in which they are begun; empty: as they are
  std::function<std::string(std::size_t)> run;           // in a process of its own
  std::function<void(std::size_t, const Answer&)> take;  // here; one by one in the order of `names`
};

// Runs at most `processes` at once; they die with this one. Shows its progress on stderr if that is a terminal;
// otherwise it only reports slow tasks.
void in_processes(const Tasks& tasks, int processes);

// The same for results of any type with a JSON form. They travel as MessagePack, whose texts need not be UTF-8. Reports
// failed tasks on stderr and returns their number.
template <class Run, class Take>
int in_processes(std::vector<std::string> names, std::vector<std::size_t> order, int processes, Run run, Take take) {
  using Json = nlohmann::json;
  int failed = 0;
  Tasks tasks{std::move(names), std::move(order), {}, {}};
  tasks.run = [&](std::size_t i) {
    const std::vector<std::uint8_t> bytes = Json::to_msgpack(run(i));
    return std::string(bytes.begin(), bytes.end());
  };
  tasks.take = [&](std::size_t i, const Answer& answer) {
    if (answer.failure.empty()) return take(Json::from_msgpack(answer.result).get<decltype(run(i))>());
    ++failed;
    fmt::print(stderr, "{}: {}\n", tasks.names[i], answer.failure);
  };
  in_processes(tasks, processes);
  return failed;
}

// One for each core that this process may use.
int usual_processes();

}  // namespace cdot::derive
