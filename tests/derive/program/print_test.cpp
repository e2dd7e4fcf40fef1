// Programs as text: names from the spec without clashes with C++ or the kernel, lines of limited length.
#include "derive/program/print.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <regex>
#include <tuple>

using namespace cdot::derive;

namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string s;
  for (const std::string& line : lines) s += line + "\n";
  return s;
}

struct Symbols {
  Pool pool;
  Expr a = pool.symbol("a", Role::given), b = pool.symbol("b", Role::given), c = pool.symbol("c", Role::given);
};

}  // namespace

TEST(Print, gives_a_named_quantity_its_own_line) {
  Symbols s;
  const Expr d = s.a * s.b;
  s.pool.name(d, "area", true);
  const std::string text = joined(print_statements(assemble({{"C[0]", d + s.c}}), {}));
  EXPECT_EQ(text, "const T area = a * b;\nC[0] = c + area;\n");
}

TEST(Print, numbers_nameless_shared_work_by_output) {
  Symbols s;
  const Expr shared = s.a * s.b;
  const std::string text =
      joined(print_statements(assemble({{"C[0]", call(Fn::sin, shared)}, {"C[1]", call(Fn::cos, shared)}}), {}));
  EXPECT_EQ(text, "const T C1_1 = a * b;\nC[0] = sin(C1_1);\nC[1] = cos(C1_1);\n");
}

TEST(Print, keeps_off_reserved_names) {
  Symbols s;
  const Expr d = s.a * s.b, e = s.b * s.c;
  s.pool.name(d, "q", true);
  s.pool.name(e, "int", true);
  Printing printing;
  printing.reserved = {"q", "int", "q_2"};
  const std::string text = joined(print_statements(assemble({{"C[0]", d + e}}), printing));
  EXPECT_NE(text.find("const T q_3 = a * b;"), std::string::npos) << text;
  EXPECT_NE(text.find("const T int_2 = b * c;"), std::string::npos) << text;
}

TEST(Print, reads_inputs_by_their_place) {
  Symbols s;
  Printing printing;
  printing.inputs = {{"a", "p.a"}, {"b", "va.w"}};
  const Program program = assemble({{"C[0]", s.a - s.b * s.c}});
  EXPECT_EQ(joined(print_statements(program, printing)), "C[0] = p.a - va.w * c;\n");
  EXPECT_EQ(inputs_read(program, printing), (std::set<std::string>{"p.a", "va.w", "c"}));
}

TEST(Print, computes_nothing_twice) {
  Symbols s;
  const Expr square = s.a * s.b;
  const Program program = assemble({{"H[0]", -square}, {"H[1]", -square}, {"H[2]", square * square}});
  const std::string text = joined(print_statements(program, {}));
  const std::regex multiply(R"( \* )"), minus(R"(-)");
  EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), multiply), {}), count(program).multiply)
      << text;
  EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), minus), {}), count(program).add) << text;
}

// For a counting type -T(2) * a would cost one negation more than in the ledger.
TEST(Print, has_no_minus_sign_that_a_number_can_take) {
  Symbols s;
  const Rational minus_one(-1), minus_two(-2);
  const std::vector<std::tuple<Expr, std::string, int>> cases = {{minus_two * s.a, "T(-2) * a", 0},
                                                                 {minus_two * s.a - s.b, "T(-2) * a - b", 1},
                                                                 {-s.a + minus_two * s.b, "T(-2) * b - a", 1},
                                                                 {s.a + minus_two * s.b, "a - T(2) * b", 1},
                                                                 {-s.a - s.pool.number(3), "T(-3) - a", 1},
                                                                 {-s.a - s.b, "-a - b", 2},
                                                                 {minus_one * s.a, "-a", 1}};
  for (const auto& [e, text, additions] : cases) {
    const Program program = assemble({{"C[0]", e}});
    EXPECT_EQ(joined(print_statements(program, {})), "C[0] = " + text + ";\n");
    EXPECT_EQ(count(program).add, additions) << text;
  }
}

TEST(Print, leaves_zeros_out_where_they_stand_already) {
  Symbols s;
  Printing printing;
  printing.zeroed = true;
  const Program program = assemble({{"D[0]", s.pool.number(0)}, {"D[1]", s.a}});
  EXPECT_EQ(joined(print_statements(program, printing)), "D[1] = a;\n");
}

TEST(Print, breaks_long_lines_at_outer_operators) {
  std::string sum = "K[0] = first";
  for (int i = 0; i < 30; ++i) sum += " + term_" + std::to_string(i) + " * (x - y)";
  const std::vector<std::string> lines = wrapped("  " + sum + ";");
  EXPECT_GT(lines.size(), 4u);
  std::string again;
  for (const std::string& line : lines) {
    EXPECT_LE(line.size(), 100u) << line;
    again += line.substr(std::min(line.size(), line.find_first_not_of(' '))) + " ";
  }
  EXPECT_EQ(again, sum + "; ") << "only spaces were changed";
  for (std::size_t i = 1; i < lines.size(); ++i) EXPECT_EQ(lines[i].find_first_not_of(' '), 6u) << lines[i];
}
