// The other formats: HTML is well-formed and self-contained, LaTeX compiles or is at least balanced, and another
// program confirms the JSON.
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "support.hpp"
#include "tests/shell.hpp"

using namespace cdot::derive;
using cdot::test::ShellResult, cdot::test::shell;
namespace fs = std::filesystem;

namespace {

ShellResult run(const std::string& command) { return shell(command + " 2>&1"); }

// An empty folder for this test.
fs::path folder(const std::string& name) {
  const fs::path path = fs::temp_directory_path() / ("cdot_explain_" + name + "_" + std::to_string(getpid()));
  fs::remove_all(path);
  fs::create_directories(path);
  return path;
}

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

// Braces, environments and \left ... \right open and close in order.
std::string imbalance(const std::string& latex) {
  std::vector<std::string> open;
  const std::regex token(R"(\\begin\{(\w+\*?)\}|\\end\{(\w+\*?)\}|\\left\b|\\right\b|\\.|[{}$])");
  for (std::sregex_iterator it(latex.begin(), latex.end(), token), end; it != end; ++it) {
    const std::string text = it->str();
    std::string opens, closes;
    if (text.starts_with("\\begin{")) opens = (*it)[1];
    else if (text.starts_with("\\end{")) closes = (*it)[2];
    else if (text == "\\left") opens = "left";
    else if (text == "\\right") closes = "left";
    else if (text == "{") opens = "{";
    else if (text == "}") closes = "{";
    else if (text == "$") (!open.empty() && open.back() == "$" ? closes : opens) = "$";
    if (!opens.empty()) open.push_back(opens);
    if (closes.empty()) continue;
    if (open.empty() || open.back() != closes) return "`" + text + "` at " + std::to_string(it->position());
    open.pop_back();
  }
  return open.empty() ? "" : "`" + open.back() + "` stays open";
}

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

const std::string python = CDOT_PYTHON;

// Runs sympy in a separate process.
ShellResult check_json(const fs::path& files) {
  return run(python + " " + quoted(fs::path(CDOT_SOURCE_DIR "/tests/derive/explain") / "check_json.py") + " " +
             quoted(files));
}

}  // namespace

TEST(ExplainHtml, IsWellFormedAndNeedsNothingFromElsewhere) {
  const fs::path pages = folder("html");
  for (const std::string& name : spec_names()) {
    const std::string page = explanation_html(explain(read_spec(name)));
    EXPECT_EQ(page.find("http"), std::string::npos) << name;
    EXPECT_EQ(page.find("src="), std::string::npos) << name;
    EXPECT_EQ(page.find("href"), std::string::npos) << name;
    EXPECT_EQ(page.find("@import"), std::string::npos) << name;
    for (std::size_t at = 0; (at = page.find("url(", at)) != std::string::npos; ++at)
      EXPECT_EQ(page.compare(at, 9, "url(data:"), 0) << name;
    EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos) << name;
    write(pages / (flat(name) + ".html"), page);
  }
  const ShellResult parsed = run(python +
                                 " -c \"import sys, glob, xml.etree.ElementTree as E\n"
                                 "files = glob.glob(sys.argv[1] + '/*.html')\n"
                                 "assert len(files) > 15\n"
                                 "[E.parse(f) for f in files]\" " +
                                 quoted(pages));
  EXPECT_EQ(parsed.status, 0) << parsed.text;
  fs::remove_all(pages);
}

// Where no font for formulas is installed, in a browser: the index of r_a stands a fifth of a line below its letter.
TEST(ExplainHtml, IndicesStandBelowTheLine) {
  std::string page = explanation_html(explain(read_spec("distance")));
  const std::regex installed("\"Latin Modern Math\".*\"Cdot Math\"");
  ASSERT_TRUE(std::regex_search(page, installed));
  page = std::regex_replace(page, installed, "\"Cdot Math\"");
  page.replace(page.rfind("</body>"), 7,
               "<script>document.fonts.load('20px \"Cdot Math\"').then(() => {\n"
               "const [letter, index] = document.querySelector('msub').children;\n"
               "const bottom = e => e.getBoundingClientRect().bottom;\n"
               "document.body.dataset.below = ((bottom(index) - bottom(letter)) / 20).toFixed(3); });</script></body>");
  const fs::path place = folder("indices");
  write(place / "page.html", page);
  const ShellResult seen =
      run(CDOT_CHROMIUM " --headless --no-sandbox --disable-gpu --virtual-time-budget=2000 --user-data-dir=" +
          quoted(place / "profile") + " --dump-dom " + "file://" + (place / "page.html").string());
  std::smatch below;
  ASSERT_TRUE(std::regex_search(seen.text, below, std::regex("data-below=\"(-?[0-9.]+)\"")))
      << seen.text.substr(0, 500);
  EXPECT_NEAR(std::stod(below[1]), 0.2, 0.1);
  fs::remove_all(place);
}

TEST(ExplainLatex, BalancesAndCompilesWhereATexIsInstalled) {
  const bool has_tex = run("command -v pdflatex").status == 0;
  const fs::path papers = folder("latex");
  for (const std::string& name : spec_names()) {
    const std::string latex = explanation_latex(explain(read_spec(name)));
    EXPECT_EQ(imbalance(latex), "") << name;
    for (const char c : latex) ASSERT_LT(static_cast<unsigned char>(c), 128) << name << ": not ASCII";
    if (!has_tex) continue;
    write(papers / (flat(name) + ".tex"), latex);
    const ShellResult compiled =
        run("cd " + quoted(papers) + " && pdflatex -interaction=nonstopmode -halt-on-error " + flat(name) + ".tex");
    EXPECT_EQ(compiled.status, 0) << compiled.text;
  }
  std::cout << (has_tex ? "compiled by pdflatex\n" : "no pdflatex here: balance checked only\n");
  fs::remove_all(papers);
}

TEST(ExplainLatex, TheBalanceCheckCanFail) {
  EXPECT_EQ(imbalance("\\begin{a} $x$ {\\left( y \\right)} \\{ \\end{a}"), "");
  EXPECT_NE(imbalance("\\begin{a} { \\end{a}"), "");
  EXPECT_NE(imbalance("\\left( x"), "");
  EXPECT_NE(imbalance("$x"), "");
}

TEST(ExplainJson, IsTrueForTheCatalogueWhenSympyEvaluatesIt) {
  const fs::path files = folder("json");
  for (const std::string& name : spec_names()) {
    const Derivation derivation = read_spec(name);
    write(files / (flat(name) + ".json"), explanation_json(derivation));
  }
  const ShellResult ran = check_json(files);
  EXPECT_EQ(ran.status, 0) << ran.text;
  std::cout << ran.text;
  fs::remove_all(files);
}

TEST(ExplainJson, IsTrueForUnusualJointsWhenSympyEvaluatesIt) {
  const fs::path files = folder("unusual_json");
  for (const auto& [name, text] : unusual_specs()) {
    write(files / (name + ".json"), explanation_json(read_text(name, text)));
  }
  const ShellResult ran = check_json(files);
  EXPECT_EQ(ran.status, 0) << ran.text;
  std::cout << ran.text;
  fs::remove_all(files);
}

// check_json.py rejects a file that it accepted before one entry was changed.
TEST(ExplainJson, TheCheckFindsAWrongEntry) {
  const fs::path files = folder("wrong_json");
  for (const std::string key : {"J", "K", "gamma", "Cdot"}) {
    fs::remove_all(files);
    fs::create_directories(files);
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(explanation_json(read_spec("line")));
    nlohmann::ordered_json& entry = json[key][0].is_array() ? json[key][0][0] : json[key][0];
    entry = "-(" + entry.get<std::string>() + ")";
    write(files / "line.json", json.dump(1));
    const ShellResult ran = check_json(files);
    EXPECT_EQ(ran.status, 1) << key << "\n" << ran.text;
    EXPECT_NE(ran.text.find("line"), std::string::npos) << ran.text;
  }
  fs::remove_all(files);
}

TEST(ExplainCommand, WritesFilesAndSaysWhatIsWrong) {
  const fs::path out = folder("command");
  const std::string specs = " --specs " + quoted(CDOT_SOURCE_DIR "/specs"), cdot = CDOT;
  const ShellResult text = run(cdot + " explain line" + specs);
  EXPECT_EQ(text.status, 0);
  EXPECT_EQ(text.text, explanation_text(explain(read_spec("line"))));
  const ShellResult page = run(cdot + " explain line --format html -o " + quoted(out / "line.html") + specs);
  EXPECT_EQ(page.status, 0) << page.text;
  EXPECT_TRUE(fs::exists(out / "line.html"));
  const auto singular = [&](const char* joint) {
    return run(cdot + " explain " + joint + " --format html" + specs).text.find("<h2>Where K is singular, or a guard");
  };
  EXPECT_EQ(singular("line"), std::string::npos);
  EXPECT_NE(singular("spherical_spherical"), std::string::npos);
  const ShellResult json = run(cdot + " explain line --json" + specs);
  EXPECT_EQ(nlohmann::json::parse(json.text)["joint"], "line");
  EXPECT_NE(run(cdot + " explain --help").text.find("intermediates"), std::string::npos);

  const ShellResult unknown = run(cdot + " explain lime" + specs);
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.text.find("did you mean `line`"), std::string::npos) << unknown.text;
  EXPECT_EQ(run(cdot + " explain line --format pdf" + specs).status, 2);
  EXPECT_EQ(run(cdot + " explain line --format html --json" + specs).status, 2);
  EXPECT_EQ(run(cdot + " explain line -o " + quoted(out / "none" / "x.txt") + specs).status, 2);
  // A file that cannot be written to its end leaves the earlier one as it was.
  const auto kept = out / "kept.txt";
  std::ofstream(kept) << "before";
  EXPECT_EQ(run("trap '' XFSZ; ulimit -f 1; " + cdot + " explain line --format html -o " + quoted(kept) + specs).status,
            2);
  std::ifstream after(kept);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(after), {}), "before");
  const ShellResult form = run(cdot + " explain line --form local" + specs);
  EXPECT_EQ(form.status, 2);
  EXPECT_NE(form.text.find("for spatial joints"), std::string::npos) << form.text;
  write(out / "ball.joint", "joint ball spatial\n  \"pin\"\n  point pa on a\n  point pb on b\n  pa = pb\n");
  const ShellResult ball = run(cdot + " explain " + quoted(out / "ball.joint") + " --form euler" + specs);
  EXPECT_EQ(ball.status, 0);
  EXPECT_NE(ball.text.find("J_euler = [ E | -2 S(ra) G_a | -E | 2 S(rb) G_b ]"), std::string::npos) << ball.text;
  write(out / "bad.joint", "joint bad planar\n  point pa on\n");
  EXPECT_EQ(run(cdot + " explain " + quoted(out / "bad.joint") + specs).status, 2);
  fs::remove_all(out);
}
