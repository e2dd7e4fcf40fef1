// One kernel, many scalar types: packs have the bits of their lanes, floats approximate doubles, and a counting type
// agrees with the ledger.
#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <cdot/pack.hpp>

#include "tests/kernels/counted.hpp"
#include "tests/kernels/law.hpp"
#include "tests/kernels/packs.hpp"

using namespace cdot;

std::string cdot::specs_folder() { return CDOT_SPECS; }

namespace {

template <class T>
struct Packs : testing::Test {};
using PackTypes =
    testing::Types<Pack<float, 4>, Pack<float, 8>, Pack<float, 16>, Pack<double, 4>, Pack<double, 8>, Pack<double, 16>>;
TYPED_TEST_SUITE(Packs, PackTypes);

// One input per lane, some of them singular: a guarded division in one lane must not affect others.
std::vector<Inputs> lanes_of_inputs(const AnyBlock& block, std::uint32_t seed) {
  std::vector<Inputs> lanes;
  for (const SingularInputs& singular : singular_inputs(block, seed)) {
    lanes.push_back(singular.inputs);
    lanes.push_back(random_inputs(block, seed++));
  }
  while (lanes.size() < 16) lanes.push_back(random_inputs(block, seed++));
  if (seed % 2 == 0) std::reverse(lanes.begin(), lanes.end());
  return lanes;
}

void expect_equal_bits(const AnyBlock& block, const Outputs& pack, const Outputs& scalar, std::size_t lane) {
  for (std::size_t f = 0; f < number_of_functions; ++f) {
    ASSERT_EQ(pack.of[f].size(), scalar.of[f].size());
    for (std::size_t i = 0; i < pack.of[f].size(); ++i) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(pack.of[f][i]), std::bit_cast<std::uint64_t>(scalar.of[f][i]))
          << block.space() << ' ' << block.joint << ", " << block.block << ": " << function_names[f] << ", number " << i
          << ", lane " << lane << ": " << pack.of[f][i] << " and " << scalar.of[f][i];
    }
  }
}

using Key = std::array<std::string, 4>;  // space, joint, block, function

std::map<Key, Operations> generated_ledger() {
  std::map<Key, Operations> ledger;
  std::ifstream file(CDOT_GENERATED "/ledger.csv");
  EXPECT_TRUE(file) << "no ledger";
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "space,joint,block,quantity,source,add,multiply,divide,root,compare,call,total");
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
    if (cell[4] != "generated") continue;
    const auto number = [&](std::size_t i) { return std::stoi(cell[i]); };
    ledger[{cell[0], cell[1], cell[2], cell[3]}] = {number(5), number(6), number(7), number(8), number(9), number(10)};
    EXPECT_EQ(number(11), number(5) + number(6) + number(7) + number(8) + number(9) + number(10)) << line;
  }
  return ledger;
}

std::string text(const Operations& o) {
  std::ostringstream s;
  s << o.add << " +, " << o.multiply << " *, " << o.divide << " /, " << o.root << " roots, " << o.compare
    << " comparisons, " << o.call << " calls";
  return s.str();
}

}  // namespace

// One input per lane of a scalar type; `all packs` has the lanes of each pack in turn.
template <class T>
std::vector<Inputs> inputs_for(const AnyBlock& block, std::uint32_t seed) {
  const std::vector<Inputs> inputs = lanes_of_inputs(block, seed);
  if constexpr (!std::is_same_v<T, packs::Packs>) return inputs;
  std::vector<Inputs> spread;
  packs::Packs any;
  for (std::size_t lane = 0; lane < packs::lanes; ++lane)
    spread.push_back(inputs[packs::at_lane(any, lane, [](auto&, int i) { return static_cast<std::size_t>(i); })]);
  return spread;
}

template <class Pack>
constexpr std::size_t width = sizeof(Pack) / sizeof(typename ScalarOf<Pack>::type);

// Compares each lane of a Pack, from lane `first` of the outputs on, with the same block in the pack's scalar.
template <class Pack>
void expect_bits_of_the_scalar(const AnyBlock& wide, const AnyBlock& narrow, const std::vector<Inputs>& inputs,
                               const std::vector<Outputs>& out, std::size_t first) {
  ASSERT_LE(first + width<Pack>, out.size());
  ASSERT_LE(out.size(), inputs.size());
  for (std::size_t lane = first; lane < first + width<Pack>; ++lane)
    expect_equal_bits(wide, out[lane], evaluate_one(narrow, inputs[lane]), lane - first);
}

template <class T>
void expect_lanes_of(std::size_t block, const std::vector<Inputs>& inputs, const std::vector<Outputs>& out) {
  using Scalar = typename ScalarOf<T>::type;
  SCOPED_TRACE(testing::Message() << width<T> << " lanes of " << sizeof(Scalar) << " bytes");
  ASSERT_EQ(blocks<packs::Packs>().size(), blocks<Scalar>().size());
  expect_bits_of_the_scalar<T>(blocks<packs::Packs>()[block], blocks<Scalar>()[block], inputs, out,
                               packs::first_lane<T>);
}

// One test for all packs: they are computed together, which takes most of its time.
TEST(AllPacks, every_lane_has_the_bits_of_the_scalar) {
  const std::vector<AnyBlock>& wide = blocks<packs::Packs>();
  for (std::size_t b = 0; b < wide.size(); ++b) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const std::vector<Inputs> inputs = inputs_for<packs::Packs>(wide[b], 100 * seed);
      const std::vector<Outputs> out = wide[b].evaluate(inputs);
      [&]<class... T>(std::type_identity<testing::Types<T...>>) {
        (expect_lanes_of<T>(b, inputs, out), ...);
      }(std::type_identity<PackTypes>{});
    }
  }
}

// A kernel compiled for all packs at once has the same bits as one compiled for a single pack.
TYPED_TEST(Packs, a_kernel_compiled_for_one_pack_has_these_bits) {
  ASSERT_GE(some_blocks<TypeParam>().size(), 8u);
  for (const AnyBlock& wide : some_blocks<TypeParam>()) {
    const std::vector<AnyBlock>& narrow = blocks<typename ScalarOf<TypeParam>::type>();
    const auto same = std::find_if(narrow.begin(), narrow.end(), [&](const AnyBlock& n) {
      return n.space() == wide.space() && n.joint == wide.joint && n.block == wide.block;
    });
    ASSERT_NE(same, narrow.end());
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const std::vector<Inputs> inputs = inputs_for<TypeParam>(wide, 100 * seed);
      expect_bits_of_the_scalar<TypeParam>(wide, *same, inputs, wide.evaluate(inputs), 0);
    }
  }
}

TEST(Floats, come_close_to_doubles) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const Outputs fine = evaluate_one(block, in);
    const auto index = static_cast<std::size_t>(&block - blocks<double>().data());
    const Outputs coarse = evaluate_one(blocks<float>()[index], in);
    const double condition = 1 + vector(fine.of[factor]).norm() * vector(fine.of[effective_mass]).norm();
    for (std::size_t f = 0; f < number_of_functions; ++f) {
      const double scale = f == solve || f == factor ? condition * condition : 1 + vector(fine.of[f]).norm();
      expect_near(block, function_names[f], vector(coarse.of[f]), vector(fine.of[f]), 2e-5 * scale);
    }
  });
}

TEST(Floats, stay_finite_at_singular_poses) {
  for (const AnyBlock& block : blocks<float>()) {
    for (const auto& [name, in] : singular_inputs(block, 3)) {
      const Outputs out = evaluate_one(block, in);
      for (std::size_t f = 0; f < number_of_functions; ++f) {
        for (const double x : out.of[f]) {
          EXPECT_TRUE(std::isfinite(x)) << block.space() << ' ' << block.joint << ", " << block.block << ": "
                                        << function_names[f] << " at: " << name;
        }
      }
    }
  }
}

TEST(Counted, has_the_bits_of_a_double) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const auto index = static_cast<std::size_t>(&block - blocks<double>().data());
    expect_equal_bits(block, evaluate_one(blocks<counting::Counted>()[index], in), evaluate_one(block, in), 0);
  });
}

TEST(Counted, agrees_with_the_ledger) {
  const std::map<Key, Operations> ledger = generated_ledger();
  std::size_t compared = 0;
  for (const AnyBlock& block : blocks<counting::Counted>()) {
    const Outputs out = evaluate_one(block, random_inputs(block, 1));
    for (std::size_t f = 0; f < number_of_functions; ++f) {
      if (out.of[f].empty()) continue;  // it has no such function
      if (block.immovable >= 0 && inherited_by_variants(static_cast<Function>(f))) continue;
      const auto row =
          ledger.find({std::string(block.space()), block.joint, block.block, std::string(function_names[f])});
      ASSERT_NE(row, ledger.end()) << block.space() << ' ' << block.joint << ", " << block.block << ": "
                                   << function_names[f];
      EXPECT_EQ(out.cost[f], row->second)
          << block.space() << ' ' << block.joint << ", " << block.block << ": " << function_names[f] << " does "
          << text(out.cost[f]) << "; the ledger says " << text(row->second);
      ++compared;
    }
  }
  // The ledger also has C, J and K of each block that is not a variant.
  std::size_t general = 0;
  for (const AnyBlock& block : blocks<double>()) general += block.immovable < 0;
  // Effects on the coordinate of any joint have rows there, but no blocks.
  const auto of_coordinates = static_cast<std::size_t>(
      std::ranges::count_if(ledger, [](const auto& row) { return std::get<0>(row.first) == "coordinate"; }));
  EXPECT_EQ(compared + 3 * general + of_coordinates, ledger.size()) << "rows of joints or blocks that do not exist";
}
