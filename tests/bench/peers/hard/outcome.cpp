#include "tests/bench/peers/hard/outcome.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/bench/peers/hard/spoilt.hpp"

namespace cdot::peers {
namespace {

constexpr rlim_t most_memory = rlim_t{4} << 30;  // of a run [bytes]

constexpr std::array<const char*, 7> kinds{"survives", "wrong",    "explodes",  "gives up",
                                           "aborts",   "too slow", "cannot say"};

// Loads of joints are judged only for chains at rest.
bool of_motion(const hard::Finding& found) {
  if (std::isnan(found.value)) return false;
  for (const char* word : {"tension", "wall's force", "wall's moment", "their force"})
    if (found.what.find(word) != std::string::npos) return false;
  return true;
}

double ratio(const hard::Finding& found) {
  if (found.held() && found.bound == hard::finite_only) return 0;
  if (!std::isfinite(found.value)) return hard::finite_only;
  return found.bound > 0 ? found.value / found.bound : found.value > 0 ? hard::finite_only : 0;
}

// JSON has no infinity.
nlohmann::json number(double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(nullptr); }
double number(const nlohmann::json& json) { return json.is_null() ? hard::finite_only : json.get<double>(); }

void settle(Outcome& outcome, const std::vector<hard::Finding>& findings) {
  std::copy_if(findings.begin(), findings.end(), std::back_inserter(outcome.findings), of_motion);
  if (outcome.findings.empty()) throw CannotSay("not asked: only what joints carry is judged");
  const bool held = std::all_of(outcome.findings.begin(), outcome.findings.end(),
                                [](const hard::Finding& found) { return found.held(); });
  outcome.kind = held ? Outcome::survives : Outcome::wrong;
}

void try_it(Outcome& outcome, const hard::Case& hard_case, const Asked& asked) {
  const bool single = asked.engine->number == "float";
  hard::Trial trial(hard_case.fault + "/" + hard_case.scene, {Solver::iterative, Integrator::euler, single});
  hard_case.run(trial);
  settle(outcome, trial.findings());
}

void run(Outcome& outcome, const hard::Case& hard_case, const Asked& asked, Told& told) {
  try {
    if (const Spoilt* question = spoilt(hard_case)) judge(*question, hard_case, asked, told, outcome);
    else try_it(outcome, hard_case, asked);
  } catch (const Exploded&) {
    outcome.kind = Outcome::explodes;
  } catch (const CannotSay& reason) {
    ended(outcome, Outcome::cannot_say, reason.what());
  } catch (const std::exception& error) {
    ended(outcome, Outcome::gives_up, error.what());
  }
}

// Memory that a child shares with its parent and that survives a crash.
struct Shared {
  Told told;
  bool no_such = false;
  std::size_t size = 0;  // of the JSON
  char json[1 << 16];
};

Shared& shared() {
  static void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return *static_cast<Shared*>(memory);
}

// Redirects the engine's output; its last lines may give the reason of a crash.
int redirected() {
  char name[] = "/tmp/cdot-peers-hard-XXXXXX";
  const int file = mkstemp(name);
  unlink(name);
  return file;
}
std::string last_lines(int file) {
  char text[512] = "";
  const off_t size = lseek(file, 0, SEEK_END), take = std::min<off_t>(size, sizeof text - 1);
  if (pread(file, text, std::size_t(take), size - take) <= 0) return "";
  std::string all = text;
  while (!all.empty() && all.back() == '\n') all.pop_back();
  std::size_t at = all.size();
  for (int lines = 0; lines < 3 && at != std::string::npos && at > 0; ++lines) at = all.rfind('\n', at - 1);
  return at == std::string::npos ? all : all.substr(at + 1);
}

void limit(int what, rlim_t to) {
  const rlimit both{to, to};
  setrlimit(what, &both);
}

[[noreturn]] void child(const hard::Case& hard_case, const Asked& asked, int output) {
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  limit(RLIMIT_CPU, rlim_t(asked.longest));
  limit(RLIMIT_AS, most_memory);
  limit(RLIMIT_CORE, 0);
  try {
    const std::string text = json_of(judged(hard_case, asked, shared().told)).dump();
    shared().size = std::min(text.size(), sizeof shared().json);
    std::memcpy(shared().json, text.data(), shared().size);
  } catch (const NoSuchSetting&) {
    shared().no_such = true;
  }
  _exit(0);
}

}  // namespace

void ended(Outcome& outcome, Outcome::Kind kind, const std::string& message) {
  outcome.kind = kind;
  outcome.message = message.substr(0, 300);
  for (const char of_a_table : {'\n', '\t', '|'})
    std::replace(outcome.message.begin(), outcome.message.end(), of_a_table, ' ');
}

const hard::Finding& Outcome::worst() const {
  return *std::max_element(findings.begin(), findings.end(),
                           [](const auto& a, const auto& b) { return ratio(a) < ratio(b); });
}

bool Outcome::operator<(const Outcome& other) const {
  if (kind != other.kind) return kind < other.kind;
  if (kind == explodes || kind == gives_up) return time > other.time;
  return !findings.empty() && !other.findings.empty() && ratio(worst()) < ratio(other.worst());
}

const char* name_of(Outcome::Kind kind) { return kinds[std::size_t(kind)]; }

nlohmann::json json_of(const Outcome& outcome) {
  nlohmann::json findings = nlohmann::json::array();
  for (const hard::Finding& found : outcome.findings)
    findings.push_back({{"what", found.what}, {"value", number(found.value)}, {"bound", number(found.bound)}});
  return {{"outcome", name_of(outcome.kind)},
          {"setting", outcome.setting},
          {"changed", outcome.changed},
          {"message", outcome.message},
          {"time", outcome.time},
          {"parts", outcome.parts},
          {"findings", findings}};
}

Outcome outcome_of(const nlohmann::json& json) {
  Outcome outcome;
  const std::string kind = json.at("outcome");
  outcome.kind = Outcome::Kind(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
  outcome.setting = json.at("setting");
  outcome.changed = json.at("changed");
  outcome.message = json.at("message");
  outcome.time = json.at("time");
  outcome.parts = json.at("parts");
  for (const nlohmann::json& found : json.at("findings"))
    outcome.findings.push_back({found.at("what"), number(found.at("value")), number(found.at("bound"))});
  return outcome;
}

Outcome judged(const hard::Case& hard_case, const Asked& asked, Told& told) {
  Outcome outcome;
  told = {};
  let_move(asked, told);
  run(outcome, hard_case, asked, told);
  outcome.setting = told.setting;
  outcome.changed = told.changed;
  outcome.time = told.time;
  outcome.parts = asked.finer;
  return outcome;
}

bool judge(const hard::Case& hard_case, const Asked& asked, Outcome& outcome) {
  Shared& memory = shared();
  memory.told = {};
  memory.no_such = false;
  memory.size = 0;
  const int output = redirected();
  const pid_t process = fork();
  if (process == 0) child(hard_case, asked, output);
  int status = 0;
  waitpid(process, &status, 0);
  const std::string said = last_lines(output);
  close(output);
  if (memory.no_such) return false;
  if (memory.size > 0) {
    outcome = outcome_of(nlohmann::json::parse(memory.json, memory.json + memory.size));
    return true;
  }
  outcome = {};
  outcome.setting = memory.told.setting;
  outcome.changed = memory.told.changed;
  outcome.time = memory.told.time;
  outcome.parts = asked.finer;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || signal == SIGKILL)
    ended(outcome, Outcome::too_slow, fmt::format("no end within {} s of CPU time", asked.longest));
  else ended(outcome, Outcome::aborts, fmt::format("{}{}{}", strsignal(signal), said.empty() ? "" : ": ", said));
  return true;
}

}  // namespace cdot::peers
