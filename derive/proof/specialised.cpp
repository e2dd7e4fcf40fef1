// C, J and K of the variants of a block, and K of isotropic bodies.
#include <fmt/format.h>

#include "derive/proof/laws.hpp"

namespace cdot::derive {
namespace {

class Specialised {
 public:
  Specialised(const Joint& joint, Law& law) : joint_(joint), names_(joint, Algebra::Route::names), law_(law) {}

  // Every entry of a variant against that of the block.
  void compare(const Block& variant, const Block& block) {
    const auto body = static_cast<std::size_t>(variant.immovable);
    const std::string where = ", " + joint_.bodies[body] + " immovable: ";
    GiNaC::exmap without_mass;
    const BodySymbols symbols = body_symbols(joint_, variant.immovable);
    without_mass[names_.of(symbols.inv_m)] = 0;
    for (const ex& entry : tensor(symbols.inv_I)) without_mass[entry] = 0;
    const Expr zero = joint_.pool->number(0);
    for (std::size_t i = 0; i < block.rows.size(); ++i) {
      require_equal(variant.rows[i].C, block.rows[i].C, block.rows[i], where + "C differs from that of the block");
      for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
        const std::vector<Expr> J = columns_of(variant.rows[i].J[b]), all = columns_of(block.rows[i].J[b]);
        for (std::size_t k = 0; k < J.size(); ++k) {
          require_equal(J[k], b == body ? zero : all[k], block.rows[i],
                        where + "J differs from that of the block in the columns of " + joint_.bodies[b]);
        }
      }
      for (std::size_t j = 0; j <= i; ++j) {
        const ex K = substituted(names_.of(block.K[i][j]), without_mass);
        require_zero(law_, names_, names_.of(variant.K[i][j]) - K, block.rows[i],
                     where + "K is not that of the block without the terms of the body");
      }
    }
  }

  // Each inertia becomes a number, represented by the first entry of its tensor.
  void compare_isotropic(const Block& block) {
    GiNaC::exmap isotropic;
    std::map<const Node*, Expr> numbers;
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      const Expr inv_I = body_symbols(joint_, static_cast<int>(b)).inv_I;
      numbers.emplace(&*inv_I, tensor_component(inv_I, 0, 0));
      for (std::size_t k = 1; k < 3; ++k) {
        isotropic[names_.of(tensor_component(inv_I, k, k))] = names_.of(tensor_component(inv_I, 0, 0));
        for (std::size_t l = 0; l < k; ++l) isotropic[names_.of(tensor_component(inv_I, k, l))] = 0;
      }
    }
    for (std::size_t i = 0; i < block.rows.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const ex K = substituted(names_.of(block.K[i][j]), isotropic);
        require_zero(law_, names_, names_.of(substitute(block.K_isotropic[i][j], numbers)) - K, block.rows[i],
                     fmt::format(": K({},{}) of isotropic bodies is not that of the block", i + 1, j + 1));
      }
    }
  }

 private:
  std::vector<ex> tensor(Expr inv_I) {
    if (joint_.dimension == 2) return {names_.of(inv_I)};
    std::vector<ex> entries;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t l = 0; l <= k; ++l) entries.push_back(names_.of(tensor_component(inv_I, k, l)));
    }
    return entries;
  }

  // Equal expressions are one node.
  void require_equal(Expr a, Expr b, const ScalarRow& row, const std::string& failure) {
    if (a != b) require_zero(law_, names_, names_.of(a) - names_.of(b), row, failure);
  }

  const Joint& joint_;
  Algebra names_;
  Law& law_;
};

}  // namespace

Law variants_are_the_block(const Joint& joint, const Block& block) {
  return judged(LawId::immovable, [&](Law& law) {
    if (block.variants.empty()) law.verdict = Verdict::does_not_apply;
    Specialised specialised(joint, law);
    for (const Block& variant : block.variants) specialised.compare(variant, block);
  });
}

Law isotropic_is_the_block(const Joint& joint, const Block& block) {
  return judged(LawId::isotropic, [&](Law& law) {
    if (joint.dimension == 2) law.verdict = Verdict::does_not_apply;
    if (joint.dimension == 2) return;
    Specialised specialised(joint, law);
    specialised.compare_isotropic(block);
    for (const Block& variant : block.variants) specialised.compare_isotropic(variant);
  });
}

}  // namespace cdot::derive
