// Many Worlds at once, a thread for each core.
#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <thread>

#include "derive/python/world.hpp"

namespace cdot::python {
namespace {

// While it lives, other threads of Python cannot use the Worlds.
template <class S>
class Claim {
 public:
  explicit Claim(const std::vector<NamedWorld<S>*>& worlds) : worlds_(worlds) {
    for (NamedWorld<S>* world : worlds_) world->world();  // throws if another thread steps it
    for (NamedWorld<S>* world : worlds_) world->set_busy(true);
  }
  ~Claim() {
    for (NamedWorld<S>* world : worlds_) world->set_busy(false);
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

 private:
  const std::vector<NamedWorld<S>*>& worlds_;
};

template <class S>
void run_all(const std::vector<NamedWorld<S>*>& worlds, double h, int count, int threads,
             std::vector<std::string>& failures) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k; (k = next++) < worlds.size();) failures[k] = worlds[k]->run(h, count, nullptr);
  };
  std::vector<std::jthread> others;
  const auto most = static_cast<int>(worlds.size());
  for (int k = 1; k < std::min(threads, most); ++k) others.emplace_back(work);
  work();
}

template <class S>
void batch_in(const py::list& list, double h, int count, const py::array& out, int threads) {
  std::vector<NamedWorld<S>*> worlds;
  for (const py::handle& each : list) {
    if (!py::isinstance<NamedWorld<S>>(each)) throw py::type_error("the Worlds of a batch must be of one space");
    worlds.push_back(each.cast<NamedWorld<S>*>());
  }
  const int bodies = worlds.front()->world().body_count();
  for (std::size_t k = 0; k < worlds.size(); ++k)
    if (const int other = worlds[k]->world().body_count(); other != bodies)
      throw py::value_error(fmt::format("World {} has {} bodies, but World 0 has {}", k, other, bodies));
  constexpr py::ssize_t numbers = NamedWorld<S>::state_numbers;
  double* to = writable(out, "out", {static_cast<py::ssize_t>(worlds.size()), bodies, numbers});
  std::vector<std::string> failures(worlds.size());
  {
    const Claim<S> claim(worlds);
    const py::gil_scoped_release others_may_run;
    run_all(worlds, h, count, threads, failures);
  }
  for (NamedWorld<S>* world : worlds) world->write_states(to), to += bodies * numbers;
  for (std::size_t k = 0; k < worlds.size(); ++k)
    if (!failures[k].empty()) throw Error(fmt::format("World {} of the batch: {}", k, failures[k]));
}

}  // namespace

void batch(const py::list& worlds, double h, int count, const py::array& out, int threads) {
  if (count < 0) throw py::value_error(fmt::format("count must be >= 0, but is {}", count));
  if (py::isinstance<NamedWorld<Spatial<double>>>(worlds[0])) batch_in<Spatial<double>>(worlds, h, count, out, threads);
  else batch_in<Planar<double>>(worlds, h, count, out, threads);
}

}  // namespace cdot::python
