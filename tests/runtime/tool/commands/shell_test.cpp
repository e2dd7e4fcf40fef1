// cdot-run as a shell knows it: the version, misspelt words, completion, colours, standard input, names of scenes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/tool/run/output.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::shell_test {
namespace {

TEST(Shell, SaysItsVersion) {
  const CommandResult result = cdot_run("--version");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "cdot-run " CDOT_VERSION "\n");
}

TEST(Shell, MisspeltWordsAreUnderstood) {
  constexpr struct {
    const char *typed, *said;
  } cases[] = {
      {"simulte x", "cdot-run: no command is called `simulte`; did you mean `simulate`?\n"},
      {"diagonse x", "cdot-run: no command is called `diagonse`; did you mean `diagnose`?\n"},
      {"swim x",
       "cdot-run: no command is called `swim`: the commands are simulate, diagnose, accuracy, import, list, "},
      {"", "cdot-run: no command: the commands are simulate, diagnose, accuracy, import, list, completion\n"},
      {"--versoin", "cdot-run: no option is called `--versoin`; did you mean `--version`?\n"},
      {"simulate x.toml --stepp 3", "cdot-run: simulate has no option `--stepp`; did you mean `--step`?\n"},
      {"simulate x.toml --integrater=rk4",
       "cdot-run: simulate has no option `--integrater`; did you mean `--integrator`?\n"},
      {"simulate x.toml --method rk4", "cdot-run: simulate has no option `--method`; did you mean `--integrator`?\n"},
      {"list --qqq", "cdot-run: list has no option `--qqq`\nRun `cdot-run list --help` for more.\n"},
  };
  for (const auto& [typed, said] : cases) {
    const CommandResult result = cdot_run(typed);
    EXPECT_EQ(result.status, 2) << typed;
    EXPECT_EQ(result.err.substr(0, std::string_view(said).size()), said) << typed;
  }
}

// A program in a build folder knows the scenes and specs of its checkout from any folder.
TEST(Shell, FindsItsCheckoutFromAnyFolder) {
  const CommandResult result = run_command("cd / && '" CDOT_RUN "' simulate double_pendulum --until 0.01 -o /dev/null");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("balance"), std::string::npos) << result.out;
}

// The words that bash offers after `line`, the last of which is being typed.
std::string bash_offers(const std::string& line) {
  const std::string script = fmt::format(
      "source <(\"$0\" completion bash); COMP_WORDS=({}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
      "_cdot_run; echo \"${{COMPREPLY[*]}}\"",
      line);
  return run_command(fmt::format("bash -c '{}' '{}'", script, CDOT_RUN)).out;
}

TEST(Shell, BashCompletes) {
  EXPECT_EQ(bash_offers("cdot-run sim"), "simulate\n");
  EXPECT_EQ(bash_offers("cdot-run simulate x.toml --integrator r"), "rattle rk4 radau5\n");
  EXPECT_EQ(bash_offers("cdot-run simulate --save"), "--save-state\n");
  EXPECT_EQ(bash_offers("cdot-run completion \"\""), "bash zsh\n");
  EXPECT_EQ(bash_offers("cdot-run jacob"), "\n") << "a retired command is offered";
}

// zsh calls _describe and _arguments with the words that it may offer; here they print them.
std::string zsh_offers(const std::string& line) {
  const std::string script = fmt::format(
      "_describe() {{ print -rl -- $commands }}; _arguments() {{ print -rl -- \"$@\" }}; words=({}); "
      "CURRENT=$#words; source <(\"$0\" completion zsh)",
      line);
  return run_command(fmt::format("zsh -fc '{}' '{}'", script, CDOT_RUN)).out;
}

TEST(Shell, ZshCompletes) {
  EXPECT_NE(zsh_offers("cdot-run \"\"").find("\ndiagnose:Run a scene; report rank"), std::string::npos);
  const std::string simulate = zsh_offers("cdot-run simulate \"\"");
  EXPECT_NE(simulate.find("*--integrator["), std::string::npos) << simulate;
  EXPECT_NE(simulate.find(":value:(euler implicit rattle"), std::string::npos) << simulate;
  EXPECT_NE(simulate.find("*--project[project an inconsistent start onto C = 0]\n"), std::string::npos)
      << "a flag takes no value: " << simulate;
}

// In a terminal that `script` imitates.
std::string in_terminal(const std::string& environment) {
  const TemporaryFolder folder;
  return run_command(fmt::format("script -qec \"env {} '{}' simulate no_such.toml\" '{}'", environment, CDOT_RUN,
                                 (folder / "typescript").string()))
      .out;
}

TEST(Shell, MessagesHaveColoursInATerminalAlone) {
  const std::string red = "\033[1;31merror:\033[0m";
  EXPECT_NE(in_terminal("-u NO_COLOR TERM=xterm").find(red), std::string::npos);
  EXPECT_EQ(in_terminal("NO_COLOR=1 TERM=xterm").find('\033'), std::string::npos);
  EXPECT_EQ(in_terminal("-u NO_COLOR TERM=dumb").find('\033'), std::string::npos);
  EXPECT_EQ(cdot_run("simulate no_such.toml").err.find('\033'), std::string::npos);
}

TEST(Shell, AHyphenIsStandardInput) {
  const std::string file = (scenes_dir() / "simple_pendulum.toml").string();
  const std::string options = "--integrator rk4 --step 0.01 --until 0.1 --json";
  const CommandResult read = run_command(fmt::format("'{}' simulate - {} <'{}'", CDOT_RUN, options, file));
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_NE(read.out.find("\"scene\": \"<stdin>\""), std::string::npos) << read.out;
  const CommandResult wrong = run_command(fmt::format("echo 'dimensoin = 2' | '{}' simulate -", CDOT_RUN));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("<stdin>:1:1: error: "), std::string::npos) << wrong.err;
}

TEST(Shell, AScenesNameIsEnough) {
  const auto there = [](const std::string& arguments) {
    return run_command(fmt::format("cd '{}' && '{}' {}", source_dir().string(), CDOT_RUN, arguments));
  };
  const std::string options = " --integrator rk4 --step 0.01 --until 0.1 --json";
  EXPECT_NE(there("simulate simple_pendulum" + options).out.find("specs/scenes/simple_pendulum.toml"),
            std::string::npos);
  EXPECT_NE(there("simulate gyroscope" + options).out.find("specs/scenes/spatial/gyroscope.toml"), std::string::npos);
  EXPECT_NE(there("simulate spatial/four_bar" + options).out.find("specs/scenes/spatial/four_bar.toml"),
            std::string::npos);
  const CommandResult misspelt = there("simulate gyrscope");
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_EQ(misspelt.err, "gyrscope: error: there is no such scene\n  fix: did you mean `gyroscope`?\n1 mistake\n");
}

TEST(Shell, RecordsAndPlots) {
  const TemporaryFolder folder;
  const std::string run = "simulate " + (scenes_dir() / "four_bar.toml").string() + " --until 0.1";
  EXPECT_EQ(cdot_run(run + " --plot " + (folder / "plots.svg").string()).status, 0);
  EXPECT_NE(read_file((folder / "plots.svg").string()).find(">rate(C1.angle)</text>"), std::string::npos);
  const CommandResult csv = cdot_run(run + " --record coordinates,reactions -o -");
  EXPECT_NE(csv.out.find(",rate(C1.angle),force(A0).x,"), std::string::npos) << csv.out.substr(0, 900);
  EXPECT_EQ(cdot_run(run + " --record speed").status, 2);
}

}  // namespace
}  // namespace cdot::test::shell_test
