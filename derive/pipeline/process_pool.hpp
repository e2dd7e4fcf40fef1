// Tasks in several processes at once: GiNaC keeps its state in globals, so threads are out of the question.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace cdot::derive {

// What a task came to: its result, or why there is none ("killed by signal 9 (Killed)").
struct Answer {
  std::string result, failure;
};

struct Tasks {
  std::vector<std::string> names;                        // for people; as many as there are tasks
  std::vector<std::size_t> order;                        // in which they are begun; empty: as they are
  std::function<std::string(std::size_t)> run;           // in a process of its own
  std::function<void(std::size_t, const Answer&)> take;  // here; one by one in the order of `names`
};

// At most `processes` at once, which die with this one. Tells on stderr how far it is, if that is a terminal; otherwise
// only which task was slow.
void in_processes(const Tasks& tasks, int processes);

// One for each core that this process may use.
int usual_processes();

}  // namespace cdot::derive
