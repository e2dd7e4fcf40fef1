// generated/proofs.csv: a recorded proof is not repeated, gives the same bytes, and is valid for its derivation only.
#include "derive/pipeline/proof_record.hpp"

#include <functional>

#include "derive/language/specs_folder.hpp"
#include "tests/derive/commands/command.hpp"

namespace {

using namespace cdot::derive;

class Recorded : public Derive {
 protected:
  void SetUp() override {
    Derive::SetUp();
    for (const char* spec : {"angle.hand", "gear.joint", "target.joint"}) take(std::string("planar/") + spec);
    fs::remove(place_ / "specs/planar/line.joint");
    write("specs/planar/pair.joint", "joint pair planar\n  \"Two angles.\"\n  include angle\n  angle(b) = angle(c)\n");
    first_ = cdot("derive");
    ASSERT_EQ(first_.status, 0) << first_.text;
    right_ = files("generated");
  }

  // The number of the four specs with a recorded proof.
  int on_record(const std::string& arguments = "derive") {
    const ShellResult result = cdot(arguments);
    EXPECT_EQ(result.status, 0) << result.text;
    const std::size_t at = result.text.find(" of 4 specs are proved by the record generated/proofs.csv");
    return at == std::string::npos ? 0 : result.text[at - 1] - '0';
  }

  void replace(const std::string& file, const std::string& old, const std::string& other) const {
    std::string text = read(file);
    ASSERT_NE(text.find(old), std::string::npos) << file << " lacks " << old;
    write(file, text.replace(text.find(old), old.size(), other));
  }

  ShellResult first_;
  std::map<std::string, std::string> right_;
};

TEST_F(Recorded, GivesTheSameBytes) {
  EXPECT_EQ(first_.text.find("proved by the record"), std::string::npos);
  EXPECT_EQ(on_record(), 4);
  EXPECT_EQ(files("generated"), right_);
  EXPECT_EQ(on_record("derive --fresh"), 0);
  EXPECT_EQ(files("generated"), right_);
  // The same rows as in the catalogue.
  const std::string catalogue = content_of(fs::path(CDOT_SOURCE_DIR) / "generated/proofs.csv");
  std::istringstream rows(right_.at("proofs.csv"));
  for (std::string row; std::getline(rows, row);) {
    if (row.find(",pair,") != row.npos) continue;
    EXPECT_NE(catalogue.find(row + "\n"), std::string::npos) << row;
  }
}

TEST_F(Recorded, WhatIsShownIsSaidAgain) {
  take("spatial/p1.joint");
  const std::string derive = "(" CDOT " derive p1 -o one 2>/dev/null)", fresh = run(derive).text;
  EXPECT_NE(fresh.find("p1: shown at 8 random points"), std::string::npos) << fresh;
  fs::remove_all(place_ / "one/spatial");
  const std::string again = run(derive).text;
  EXPECT_EQ(again.substr(0, again.find("one:")), fresh.substr(0, fresh.find("one:")));
  EXPECT_NE(cdot("derive p1 -o one").text.find("1 of 1 specs"), std::string::npos);
}

// For all specs that would be a page: the record lists them.
TEST_F(Recorded, ShownLawsOfAllSpecsAreCounted) {
  take("spatial/p1.joint");
  cdot("derive");
  const std::string said = cdot("derive").text;
  EXPECT_EQ(said.find("p1: shown"), std::string::npos) << said;
  EXPECT_NE(said.find("shown at 8 random points, listed in generated/proofs.csv: 1\n"), std::string::npos) << said;
}

TEST_F(Recorded, WordsOfASpecDoNotMatter) {
  write("specs/planar/angle.joint", read("specs/planar/angle.joint") + "# more\n");
  write("specs/planar/angle.hand", read("specs/planar/angle.hand") + "# more\n");
  EXPECT_EQ(on_record(), 4);
  EXPECT_EQ(files("generated").at("proofs.csv"), right_.at("proofs.csv"));
}

TEST_F(Recorded, NotWhereTheDerivationChanged) {
  const std::string head = "joint pair planar\n  \"Two angles.\"\n  include angle\n";
  write("specs/planar/pair.joint", head + "  angle(b) + angle(c) = 0\n");
  EXPECT_EQ(cdot("derive").status, 2) << "it breaks a law, so the record must not speak for it";
  write("specs/planar/pair.joint", head + "  angle(b) = 2 * angle(c) - angle(a)\n");
  EXPECT_EQ(on_record(), 3);
  EXPECT_EQ(on_record(), 4);
}

TEST_F(Recorded, NotByADamagedRecord) {
  const std::string proofs = right_.at("proofs.csv");
  const std::size_t statement = proofs.find(",rows,", proofs.find("planar,gear")) + 6;
  std::string other_statement = proofs, unknown_law = proofs;
  other_statement[statement] = other_statement[statement] == '0' ? '1' : '0';
  unknown_law.replace(unknown_law.find("jacobian", statement), 8, "jacobean");
  for (const std::string& damaged : {other_statement, unknown_law}) {
    write("generated/proofs.csv", damaged);
    EXPECT_EQ(on_record(), 3);
    EXPECT_EQ(files("generated"), right_);
  }
  for (const std::string& damaged : {proofs.substr(0, statement), std::string(), std::string(3, '\0')}) {
    write("generated/proofs.csv", damaged);
    EXPECT_EQ(cdot("derive --check").status, 1);
    EXPECT_EQ(cdot("derive").status, 0);
    EXPECT_EQ(files("generated"), right_);
  }
}

// A false row for the right derivation: the check in CI finds it.
TEST_F(Recorded, AFreshCheckFindsAFalseRecord) {
  take("spatial/p1.joint");
  ASSERT_EQ(cdot("derive p1 -o one").status, 0);
  const auto right = files("one");
  replace("one/proofs.csv", "isotropic,stiffness ", "isotropic stiffness,");
  EXPECT_EQ(cdot("derive --check p1 -o one").status, 0);
  const ShellResult check = cdot("derive --check --fresh p1 -o one");
  EXPECT_EQ(check.status, 1);
  EXPECT_NE(check.text.find("proofs.csv: differs"), std::string::npos) << check.text;
  const std::string mend = check.text.substr(check.text.rfind("Fix: cdot ") + 10);
  EXPECT_EQ(cdot(mend.substr(0, mend.find('\n'))).status, 0) << mend;
  EXPECT_EQ(files("one"), right);
}

TEST_F(Recorded, NotWhatIsNotProved) {
  write("specs/planar/wrong.joint", "joint wrong planar\n  \"x\"\n  angle(a) + angle(b) = 0\n");
  const ShellResult once = cdot("derive wrong -o one"), again = cdot("derive wrong -o one");
  EXPECT_EQ(again.status, 2);
  EXPECT_EQ(again.text, once.text);
  EXPECT_FALSE(fs::exists(place_ / "one"));
}

// The kernel of a coordinate is emitted, so it must obey the laws like the rows.
TEST_F(Recorded, ACoordinateThatBreaksALawIsRefused) {
  write("specs/planar/wrong.joint",
        "joint wrong planar\n  \"x\"\n  angle(a) = angle(b)\n  coordinate sum = angle(a) + angle(b) + angle(c)\n");
  const ShellResult result = cdot("derive wrong -o one");
  EXPECT_EQ(result.status, 2) << result.text;
  EXPECT_NE(result.text.find("wrong.joint:4:14: error: momentum is conserved"), std::string::npos) << result.text;
}

TEST(Statement, ChangesWithEveryPartOfADerivation) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  const auto derivation = [&] { return derive(*folder.read(folder.find("slot")).joint); };
  const std::string statement = statement_of(derivation());
  EXPECT_EQ(statement.size(), 32u);
  EXPECT_EQ(statement_of(derivation()), statement);
  using Change = std::function<void(Derivation&)>;
  const auto negate = [](Expr& e) { e = -e; };
  const Change changes[] = {
      [&](Derivation& d) { negate(d.rows.rows[0].C); },
      [&](Derivation& d) { negate(d.rows.rows[0].Cdot); },
      [&](Derivation& d) { negate(d.rows.rows[0].gamma); },
      [&](Derivation& d) { negate(d.rows.rows[0].gamma_by_entries); },
      [&](Derivation& d) { negate(d.rows.rows[0].J[1].w); },
      [&](Derivation& d) { negate(d.rows.K[0][0]); },
      [&](Derivation& d) { negate(d.rows.stiffness[2][2]); },
      [&](Derivation& d) { negate(d.rows.variants[0].rows[0].J[1].w); },
      [&](Derivation& d) { negate(d.rows.variants[1].K[0][0]); },
      [&](Derivation& d) { std::swap(d.rows.variants[0].immovable, d.rows.variants[1].immovable); },
      [&](Derivation& d) { negate(d.coordinates[0].rows[0].C); },
      [&](Derivation& d) { negate(d.coordinates[0].variants[0].K[0][0]); },
      [&](Derivation& d) { d.joint.uses_world = !d.joint.uses_world; },
      [&](Derivation& d) { d.rows.rows[0].kind = RowKind::inequality; },
      [&](Derivation& d) { d.rows.rows[0].of_world = !d.rows.rows[0].of_world; },
      [&](Derivation& d) { d.coordinates.pop_back(); },
  };
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    Derivation changed = derivation();
    changes[i](changed);
    EXPECT_NE(statement_of(changed), statement) << "change " << i;
  }
}

}  // namespace
