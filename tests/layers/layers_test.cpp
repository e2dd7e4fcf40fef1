// The architecture as a table: a room includes only itself and rooms above it in its list. The test checks every
// #include in derive/ and runtime/. These two share a few rooms and otherwise do not include each other, but for the
// compiler of scenes, a program of its own; neither includes the tests.
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path source_dir = CDOT_SOURCE_DIR;

// clang-format off
const std::set<std::string> shared_rooms = {"runtime/text", "runtime/command_line", "runtime/tape"};  // of derive/ too
// Scenes by the runtime, kernels and derivations by the generator: these rooms include both.
const std::vector<std::string> bridges = {"derive/compile", "derive/play", "derive/python"};

// The parts of the generator that cdot-run may include: expressions of scenes, and joints without a compiler. The
// runtime's library includes nothing.
const std::set<std::string> doors = {"derive/interpret/formula.hpp", "derive/own/own_kernel.hpp"};

const std::vector<std::string> rooms = {
    "runtime/text",          // a line with carets, the nearest word, JSON, files
    "runtime/command_line",  // arguments to the options of a command
    "runtime/include/cdot",  // what programs include; its kernel.hpp is the contract of both halves
    "runtime/tape",          // straight-line programs over any number type

    // The generator: text in, kernels and derivations out.
    "derive/expression",   // interned expressions over vectors
    "derive/syntax",       // text to tree, with places and messages
    "derive/language",     // tree to joint: names, units, operators
    "derive/language/hand",
    "derive/numbers",      // expressions at poses: doubles, modulo a prime
    "derive/picture",      // a joint at a pose, drawn
    "derive/derivation",   // C to Cdot, J, K, gamma
    "derive/program",      // expressions to straight-line code, simplified
    "derive/interpret",    // expressions of a scene, read and evaluated without a compiler
    "derive/explain",      // the derivation as a lecture
    "derive/explain/formats",  // as text, HTML, LaTeX and JSON
    "derive/proof",        // the laws, by GiNaC
    "derive/kernel",       // programs to C++
    "derive/engines",      // kernels to joints of other engines
    "derive/own",          // a kernel as tapes, for programs without a compiler
    "derive/check", "derive/diff",
    "derive/diff/slips",   // one slip that explains a whole matrix
    "derive/pipeline",     // read, derive, prove, print
    "derive/commands",
    "derive",              // main()

    // The runtime. Programs include <cdot/...>; detail/ is for compiling a program's own joints.
    "runtime/include/cdot/detail",
    "runtime/number",
    "runtime/space",       // plane and space
    "runtime/rows",        // joints as blocks of rows, and the laws of their impulses
    "runtime/direct",      // the sparse system of an island
    "runtime/state",       // all data of a World
    "runtime/motion",      // forces, poses and momentum, without joints
    "runtime/balance",     // energy, work and momentum of a World
    "runtime/solve",       // rows of an island, their forces and projection
    "runtime/events",      // rows under a law between events; impacts, latches, joints that break
    "runtime/sweeps",      // steps by sweeps whose energy does not rise: soft rows, the price of a gain
    "runtime/step",        // integrators
    "runtime/world",       // step() itself; islands, sleep, queries
    "runtime/effects",     // effects of specs on coordinates, their short forms; breaking
    "runtime/diagnose",
    "runtime/own",         // joints made while a program runs
    "runtime/engines",     // kernels in other engines: texts of `cdot emit`, built by its tests alone
    // cdot-run.
    "runtime/tool/scene",
    "runtime/tool/watch",  // ranks and concerns along a run
    "runtime/tool/run",
    "runtime/tool/compiled",  // scenes by the machine's compiler
    "runtime/tool/search", // many runs of a scene: for an accuracy, for advice
    "runtime/tool/viewer", "runtime/tool/accuracy",
    "runtime/tool/import", // robot descriptions to scenes
    "runtime/tool/commands",
    "runtime/tool",
    // cdot-compile.
    "derive/compile/scene", // a scene as numbers
    "derive/compile/rows", // its rows and laws as programs
    "derive/compile/borne", // forces of effects that may break
    "derive/compile/readings", // coordinates and what joints carry
    "derive/compile/foresight", // rounds of Newton that begin close to the end
    "derive/compile/one_freedom", // a mechanism of one freedom in a few angles
    "derive/compile/methods",  // its steps as text
    "derive/compile/bounded", // impulses of rows with bounds as text
    "derive/compile/rattle", // RATTLE as text
    "derive/compile/midpoint", // the implicit midpoint rule, in programs and text
    "derive/compile/collocation", // Radau IIA as text
    "derive/compile",      // a scene to a header of its own
    "derive/play",         // the playground: its engine and its page
    "derive/play/server",  // the program that serves or writes it
    "derive/python",       // `import cdot`
};
// One room in two folders, which may include each other.
const std::map<std::string, std::string> annexes = {{"derive/language/hand", "derive/language"}, {"derive/diff/slips", "derive/diff"}};
// clang-format on

constexpr int most_files = 25;

struct Include {
  std::string file, room, of_file, of_room;
};

std::string room_of(const fs::path& file) { return file.parent_path().generic_string(); }

std::size_t rank(std::string room) {
  if (const auto annex = annexes.find(room); annex != annexes.end()) room = annex->second;
  return static_cast<std::size_t>(std::find(rooms.begin(), rooms.end(), room) - rooms.begin());
}

bool is_bridge(const std::string& room) {
  return std::any_of(bridges.begin(), bridges.end(), [&](const std::string& one) { return room.starts_with(one); });
}

std::string half_of(const std::string& room) { return room.substr(0, room.find('/')); }

bool is_source(const fs::path& file) { return file.extension() == ".cpp" || file.extension() == ".hpp"; }

std::vector<fs::path> sources() {
  std::vector<fs::path> found;
  for (const char* half : {"derive", "runtime"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source_dir / half)) {
      if (is_source(entry.path())) found.push_back(fs::relative(entry.path(), source_dir));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The file of an #include of this project, from the root; empty for others and for kernels, which are in no room.
fs::path included(const std::string& line) {
  static const std::regex quoted("#include \"((derive|runtime|tests|generated)/[^\"]*)\".*");
  static const std::regex published("#include <(cdot/[^>]*)>.*");
  std::smatch match;
  if (std::regex_match(line, match, quoted)) return match[1].str();
  if (!std::regex_match(line, match, published)) return {};
  const std::string path = match[1];
  const bool kernel =
      path.starts_with("cdot/planar/") || path.starts_with("cdot/spatial/") || path.starts_with("cdot/coordinate/");
  return kernel ? fs::path() : fs::path("runtime/include/" + path);
}

std::vector<Include> includes() {
  std::vector<Include> found;
  for (const fs::path& file : sources()) {
    std::ifstream in(source_dir / file);
    for (std::string line; std::getline(in, line);) {
      const fs::path other = included(line);
      if (!other.empty()) found.push_back({file.string(), room_of(file), other.string(), room_of(other)});
    }
  }
  return found;
}

TEST(Layers, EveryFolderIsARoomOfTheTable) {
  for (const fs::path& file : sources())
    EXPECT_LT(rank(room_of(file)), rooms.size()) << file << ": add its folder to the table in this test";
}

TEST(Layers, NoRoomIncludesARoomBelowIt) {
  const std::vector<Include> all = includes();
  ASSERT_GT(all.size(), 500u);
  for (const Include& i : all) {
    EXPECT_TRUE(fs::exists(source_dir / i.of_file)) << i.file << " includes " << i.of_file;
    const bool by_the_door =
        doors.contains(i.of_file) && (i.room.starts_with("runtime/tool/") || i.room == "runtime/own");
    EXPECT_TRUE(is_bridge(i.room) || by_the_door || shared_rooms.contains(i.of_room) ||
                half_of(i.room) == half_of(i.of_room))
        << i.file << " includes " << i.of_file << ": derive/ and runtime/ do not know each other";
    EXPECT_LE(rank(i.of_room), rank(i.room))
        << i.file << " includes " << i.of_file << ", which comes later in the table";
  }
}

TEST(Layers, PublicHeadersIncludePublicHeadersOnly) {
  for (const Include& i : includes()) {
    if (!i.room.starts_with("runtime/include/")) continue;
    EXPECT_TRUE(i.of_room.starts_with("runtime/include/")) << i.file << " is installed, " << i.of_file << " is not";
  }
}

TEST(Layers, NoRoomIsFull) {
  std::map<std::string, int> files;
  for (const fs::path& file : sources()) ++files[room_of(file)];
  for (const auto& [room, count] : files) EXPECT_LE(count, most_files) << room << ": is that one concern?";
}

}  // namespace
