// `cdot play` without -o, as a program: it serves its page to this machine alone, until it is asked to end.
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;

// The page, the scene's edition before and after a change, and a question under a foreign name.
constexpr const char* questions = R"(
import json, sys, urllib.request
at = sys.argv[1]
def ask(path, **headers):
    return urllib.request.urlopen(urllib.request.Request(at + path, headers=headers), timeout=30).read().decode()
print('<title>Cdot' in ask(''))
first = json.loads(ask('example'))
print(first['title'], json.loads(ask('example?edition=' + first['edition'])).keys() == {'edition'})
text = open('s.toml').read()
open('s.toml', 'w').write(text.replace('before', 'after'))
print(json.loads(ask('example?edition=' + first['edition']))['title'])
open('s.toml', 'w').write('type = "my')
print('title' in json.loads(ask('example')))
try:
    ask('', Host='elsewhere.example')
except urllib.error.HTTPError as error:
    print(error.code)
)";

TEST(Serve, ThePageIsForThisMachineAlone) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("cdot_serve_{}", getpid());
  fs::create_directories(folder / "engine");
  std::ofstream(folder / "engine/engine.js") << "";
  std::ofstream(folder / "engine/engine.wasm") << "x";
  std::ofstream(folder / "ask.py") << questions;
  std::ofstream(folder / "s.toml") << "title = \"before\"\n[[body]]\nname = \"b\"\nmass = 1\nshape = { disc = 1 }\n";
  const std::string script = fmt::format(
      "cd {} || exit 1; {} play s.toml --port 0 --no-browser --engine engine --specs {}/specs > said 2> errors & "
      "child=$!; "
      "for k in $(seq 300); do grep -q http said && break; sleep 0.1; done; "
      "python3 ask.py $(grep -o 'http://[0-9.:]*/' said) > answers 2>&1; kill -TERM $child; wait $child; "
      "echo status $? >> answers",
      folder.string(), CDOT_PLAY, CDOT_SOURCE_DIR);
  std::ofstream(folder / "run.sh") << script;
  ASSERT_EQ(std::system(fmt::format("bash {}/run.sh", folder.string()).c_str()), 0);
  std::ifstream answers(folder / "answers");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(answers), {}),
            "True\nbefore True\nafter\nTrue\n403\nstatus 0\n");
  fs::remove_all(folder);
}

// -o writes a page from any engine.
TEST(Serve, ItBeginsWithASceneOrASpecByName) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("cdot_begin_{}", getpid());
  fs::create_directories(folder / "engine");
  std::ofstream(folder / "engine/engine.js") << "";
  std::ofstream(folder / "engine/engine.wasm") << "x";
  const auto play = [&](const char* start) {
    return std::system(fmt::format("cd {} && {} play {} -o page --engine engine --specs {}/specs > said 2> errors",
                                   folder.string(), CDOT_PLAY, start, CDOT_SOURCE_DIR)
                           .c_str());
  };
  for (const char* start : {"four_bar", "strandbeest", "line", "spatial/hinge", "spring"})
    EXPECT_EQ(WEXITSTATUS(play(start)), 0) << start;
  EXPECT_EQ(WEXITSTATUS(play("lnie")), 2);
  std::ifstream errors(folder / "errors");
  const std::string said(std::istreambuf_iterator<char>(errors), {});
  for (const char* words : {"lnie: error: there is no such scene", "did you mean `line`?"})
    EXPECT_NE(said.find(words), std::string::npos) << said;
  fs::remove_all(folder);
}

}  // namespace
