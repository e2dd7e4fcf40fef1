// `cdot derive` from the command line: its files, --check, and no output for a broken spec.
#include "tests/derive/commands/command.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "derive/language/operators.hpp"

namespace {

const char* const broken = "joint broken planar\n  \"x\"\n  point pa on a\n  norm(pb) = 0\n";
// Angles of bodies that do not cancel: valid syntax without a proof.
const char* const wrong = "joint wrong planar\n  \"x\"\n  angle(a) + angle(b) = 0\n";
const char* const pin =
    "joint pin_on_line planar\n  \"A line with a second row.\"\n  include line\n"
    "  angle(a) - angle(b) = 0\n";

}  // namespace

// Errors about operators refer to this help.
TEST_F(Derive, TheOperatorsAreInTheHelpOfCheck) {
  const ShellResult help = cdot("check --help");
  EXPECT_EQ(help.status, 0);
  for (const ::cdot::derive::Operator& o : ::cdot::derive::operators()) {
    const std::size_t at = help.text.find("  " + std::string(o.signature) + "  ");
    EXPECT_NE(at, std::string::npos) << o.signature;
    EXPECT_NE(help.text.find(o.help, at), std::string::npos) << o.help;
  }
}

TEST_F(Derive, WritesKernelsRegistriesAndTheLedger) {
  const ShellResult derived = cdot("derive");
  EXPECT_EQ(derived.status, 0) << derived.text;
  std::string names;
  for (const auto& [name, content] : files("generated")) names += name + "\n";
  EXPECT_EQ(names,
            "coordinate/registry.hpp\nledger.csv\nplanar/angle.hpp\nplanar/line.hpp\nplanar/registry.hpp\n"
            "proofs.csv\nspatial/registry.hpp\n");
  EXPECT_EQ(read("generated/planar/line.hpp"), content_of(fs::path(CDOT_SOURCE_DIR "/generated") / "planar/line.hpp"))
      << "what is generated for a joint does not depend on the others";
}

TEST_F(Derive, WritesElsewhereIfAsked) {
  EXPECT_EQ(cdot("derive -o build/own").status, 0);
  EXPECT_TRUE(files("generated").empty());
  EXPECT_EQ(files("build/own").size(), 7u);
}

TEST_F(Derive, TouchesNothingThatIsRight) {
  ASSERT_EQ(cdot("derive").status, 0);
  const auto time = fs::last_write_time(place_ / "generated/planar/line.hpp");
  EXPECT_NE(cdot("derive").text.find("0 written, 0 removed"), std::string::npos);
  EXPECT_EQ(fs::last_write_time(place_ / "generated/planar/line.hpp"), time);
}

TEST_F(Derive, CheckNamesTheOneCommandThatMends) {
  for (const std::string options : {"", " -o own", " --specs specs line -o just_one"}) {
    ASSERT_EQ(cdot("derive" + options).status, 0);
    EXPECT_EQ(cdot("derive --check" + options).status, 0);
    const std::string folder = options.empty() ? "generated" : options.substr(options.rfind(' ') + 1);
    const auto right = files(folder);
    write(folder + "/planar/line.hpp", "changed by hand\n");
    write(folder + "/planar/stale.hpp", "no spec makes it\n");
    fs::remove(place_ / folder / "ledger.csv");
    const ShellResult check = cdot("derive --check" + options);
    EXPECT_EQ(check.status, 1);
    for (const char* words : {"line.hpp: differs", "- changed by hand", "stale.hpp: no spec generates it",
                              "ledger.csv: missing", "Fix: cdot derive"}) {
      EXPECT_NE(check.text.find(words), std::string::npos) << words << "\n" << check.text;
    }
    const std::string mend = check.text.substr(check.text.rfind("Fix: cdot ") + 10);
    EXPECT_EQ(cdot(mend.substr(0, mend.find('\n'))).status, 0) << mend;
    EXPECT_EQ(files(folder), right);
    EXPECT_EQ(cdot("derive --check" + options).status, 0);
  }
}

TEST_F(Derive, WritesNothingFromABrokenSpec) {
  ASSERT_EQ(cdot("derive").status, 0);
  const auto before = files("generated");
  for (const char* const text : {broken, wrong}) {
    write("specs/planar/bad.joint", text);
    write("specs/planar/line.joint", pin);  // changes generated files
    for (const char* const command : {"derive", "derive --check"}) {
      const ShellResult result = cdot(command);
      EXPECT_EQ(result.status, 2) << result.text;
      EXPECT_NE(result.text.find("bad.joint:"), std::string::npos) << result.text;
      EXPECT_EQ(files("generated"), before);
    }
  }
}

TEST_F(Derive, SaysWhichSpecIsMissing) {
  const ShellResult result = cdot("derive lin");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.text.find("did you mean `line`"), std::string::npos) << result.text;
  EXPECT_TRUE(files("generated").empty());
  EXPECT_EQ(run("mkdir away && cd away && " CDOT " derive").status, 2);
  EXPECT_EQ(cdot("derive --such").status, 2);
}

TEST_F(Derive, TakesUpANewJointThatIncludesAnother) {
  ASSERT_EQ(cdot("derive").status, 0);
  write("specs/planar/pin_on_line.joint", pin);
  EXPECT_EQ(cdot("derive --check").status, 1);
  const ShellResult derived = cdot("derive");
  EXPECT_EQ(derived.status, 0) << derived.text;
  EXPECT_NE(read("generated/planar/registry.hpp").find("pin_on_line"), std::string::npos);
  EXPECT_NE(read("generated/planar/pin_on_line.hpp").find("struct pin_on_line"), std::string::npos);
  fs::remove(place_ / "specs/planar/pin_on_line.joint");
  EXPECT_EQ(cdot("derive").status, 0);
  EXPECT_FALSE(files("generated").contains("planar/pin_on_line.hpp"));
}

// During a write a reader sees the old file or the new one.
TEST_F(Derive, NeverShowsHalfAFile) {
  const std::string one = content_of(fs::path(CDOT_SOURCE_DIR "/specs") / "planar/line.joint");
  const std::string other = one + "  second: angle(a) = angle(b)\n";
  std::string kernels[2];
  for (int i = 0; i < 2; ++i) {
    write("specs/planar/line.joint", i == 0 ? one : other);
    ASSERT_EQ(cdot("derive line").status, 0);
    kernels[i] = read("generated/planar/line.hpp");
  }
  std::atomic<bool> done = false;
  std::jthread writer([&] {
    for (int i = 0; i < 12; ++i) {
      write("specs/planar/line.joint", i % 2 == 0 ? one : other);
      cdot("derive line");
    }
    done = true;
  });
  int seen[2] = {0, 0}, halves = 0;
  while (!done) {
    const std::string now = read("generated/planar/line.hpp");
    if (now == kernels[0]) {
      ++seen[0];
    } else if (now == kernels[1]) {
      ++seen[1];
    } else {
      ++halves;
    }
  }
  std::printf("read %d times the one, %d times the other, %d times half of one\n", seen[0], seen[1], halves);
  EXPECT_EQ(halves, 0);
  EXPECT_GT(std::min(seen[0], seen[1]), 0);
}

TEST_F(Derive, AHyphenIsStandardInputAndOutput) {
  const ShellResult checked = run("cat specs/planar/line.joint | " CDOT " check -");
  EXPECT_EQ(checked.status, 0);
  EXPECT_NE(checked.text.find("<stdin>: clean"), std::string::npos) << checked.text;
  write("typo.joint", broken);
  const ShellResult wrong = run("cat typo.joint | " CDOT " check -");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.text.find("<stdin>:4:8: error: "), std::string::npos) << wrong.text;
  EXPECT_EQ(cdot("explain line -o -").text, cdot("explain line").text);
  EXPECT_NE(run(CDOT " check line --html - 2>/dev/null").text.find("</html>"), std::string::npos);
  EXPECT_FALSE(fs::exists(place_ / "-"));
}

TEST_F(Derive, MisspeltWordsAreUnderstood) {
  for (const auto& [typed, said] : std::map<std::string, std::string>{
           {"explian line", "cdot: no command is called `explian`; did you mean `explain`?\n"},
           {"diff --ful", "cdot: diff has no option `--ful`; did you mean `--full`?\n"},
           {"--version", "cdot 0."}})
    EXPECT_EQ(cdot(typed).text.substr(0, said.size()), said);
}

// `compile` and `play` are programs of their own, which know their options.
TEST_F(Derive, OptionsOfProgramsBesideAreCompleted) {
  const std::string path = "export PATH=\"$(dirname " CDOT "):$PATH\"; ";
  write("bash", path +
                    "source <(cdot completion bash); COMP_WORDS=(cdot compile --in); COMP_CWORD=2; _cdot; "
                    "echo ${COMPREPLY[@]}; COMP_WORDS=(cdot play --po); _cdot; echo ${COMPREPLY[@]}\n");
  EXPECT_EQ(run("bash bash").text, "--integrator --input\n--port\n");
  write("zsh", path +
                   "_arguments() { print -rl -- \"$@\" }; words=(cdot compile \"\"); CURRENT=3; "
                   "source <(cdot completion zsh)\n");
  EXPECT_NE(run("zsh -f zsh").text.find("--bill:value:_files\n--json"), std::string::npos);
}

// The catalogue of an installation must not be written into the folder where somebody happens to be.
TEST_F(Derive, WithoutASpecsFolderNothingIsDerived) {
  fs::remove_all(place_ / "specs");
  const ShellResult derived = cdot("derive");
  EXPECT_EQ(derived.status, 2);
  EXPECT_NE(derived.text.find("no folder specs: run from the folder that holds it"), std::string::npos) << derived.text;
  EXPECT_FALSE(fs::exists(place_ / "generated"));
}

// An editor's lock is a link to no file, and a link may lead to itself.
TEST_F(Derive, LinksThatLeadNowhereAreNoSpecs) {
  fs::create_symlink("me@machine.123", place_ / "specs/planar/.#line.joint");
  fs::create_symlink("loop.joint", place_ / "specs/planar/loop.joint");
  const ShellResult beside = cdot("check specs/planar/line.joint");
  EXPECT_EQ(beside.status, 0) << beside.text;
  EXPECT_EQ(cdot("derive").status, 0);
  const ShellResult itself = cdot("check specs/planar/loop.joint");
  EXPECT_EQ(itself.status, 2);
  EXPECT_NE(itself.text.find("loop.joint: cannot be read: Too many levels of symbolic links"), std::string::npos)
      << itself.text;
}

TEST_F(Derive, SaysWhatANameThatIsNoSpecMeans) {
  write("own.joint", pin);
  write("folder.joint/notes", "");
  for (const auto& [name, words] : {std::pair("own", "no spec is called `own`; did you mean `own.joint`?"),
                                    std::pair("nothing.joint", "no such file: nothing.joint"),
                                    std::pair("folder.joint", "folder.joint: this is a folder, not a spec"),
                                    std::pair("lnie", "did you mean `line`?")}) {
    const ShellResult said = cdot(std::string("check ") + name);
    EXPECT_EQ(said.status, 2) << name;
    EXPECT_NE(said.text.find(words), std::string::npos) << said.text;
  }
}
