#include "derive/pipeline/proof_record.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <sstream>
#include <tuple>

namespace cdot::derive {
namespace {

constexpr const char* header = "space,joint,block,statement,proved,shown\n";

__extension__ using Wide = unsigned __int128;

// FNV-1a with 128 bits.
std::string hash_of(std::string_view text) {
  const Wide prime = (Wide{1} << 88) + 0x13b;
  Wide hash = (Wide{0x6c62272e07bb0142} << 64) + 0x62b821756295c58d;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * prime;
  return fmt::format("{:016x}{:016x}", static_cast<std::uint64_t>(hash >> 64), static_cast<std::uint64_t>(hash));
}

// Appends the rows of a block and its variants as text, and all their expressions in a fixed order.
void add(const Block& block, std::string& text, std::vector<Expr>& all) {
  const auto take = [&](const std::vector<Expr>& some) { all.insert(all.end(), some.begin(), some.end()); };
  text += fmt::format("block {} {}\n", block.name, block.immovable);
  for (const ScalarRow& row : block.rows) {
    text += fmt::format("{} {} {}{}\n", row.name, static_cast<int>(row.kind), row.component,
                        row.of_world ? " of the world" : "");
    for (const Expr e : {row.C, row.Cdot, row.C_t, row.gamma, row.gamma_by_entries}) {
      if (e) all.push_back(e);
    }
    take(columns_of(row.J));
  }
  for (const auto* matrix : {&block.K, &block.K_isotropic, &block.stiffness}) {
    for (const std::vector<Expr>& row : *matrix) take(row);
  }
  take(block.lambda);
  for (const Block& variant : block.variants) add(variant, text, all);
}

// The same of the law of an effect.
void add(const DerivedLaw& law, std::string& text, std::vector<Expr>& all) {
  text += fmt::format("law {} {} {}", word_of(LawId::force), word_of(LawId::slopes), word_of(LawId::opposite));
  const auto take = [&](const std::vector<Expr>& some) {
    std::ranges::copy_if(some, std::back_inserter(all), &Expr::operator bool);
  };
  for (const auto* some : {&law.value, &law.rate, &law.force, &law.unstored}) take(*some);
  if (law.energy) all.push_back(law.energy);
  for (const auto* matrix : {&law.stiffness, &law.damping}) std::ranges::for_each(*matrix, take);
}

// The graph of the expressions as text: each node by its own contents and the numbers of its operands.
std::string text_of_graph(const Pool& pool, const std::vector<Expr>& roots) {
  std::string text;
  std::map<const Node*, std::size_t> numbers;
  const auto number = [&](Expr e) { return numbers.at(&*e); };
  for (const Expr e : topological(roots)) {
    const Pool::Axis axis = pool.axis_of(e);
    text += fmt::format("{} {} {} {} {} {} {} {} {} {}", static_cast<int>(e->kind), e->vector, e->unit_length,
                        e->value.text(), e->symbol, static_cast<int>(e->role), e->body, name_of(e->fn), axis.index,
                        axis.triad == nullptr ? "" : (*axis.triad)[0]->symbol);
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      text += fmt::format(" {}:{}:{}", number(e->args[i]), i < e->coefs.size() ? e->coefs[i].text() : "",
                          i < e->exponents.size() ? e->exponents[i] : 1);
    }
    text += '\n';
    numbers.emplace(&*e, numbers.size());
  }
  for (const Expr root : roots) text += fmt::format("{} ", number(root));
  return text;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

bool are_laws(const std::string& words) {
  const std::vector<std::string> all = split(words, ' ');
  return std::all_of(all.begin(), all.end(), [](const std::string& word) { return law_of(word).has_value(); });
}

std::string words_of(const Proof& proof, Verdict verdict) {
  std::string words;
  for (const Law& law : proof.laws) {
    if (law.verdict == verdict) words += (words.empty() ? "" : " ") + std::string(word_of(law.id));
  }
  return words;
}

}  // namespace

std::string statement_of(const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  std::string text = fmt::format("{} {} {} {}\n", joint.dimension, joint.uses_world, joint.uses_time, exact_points);
  for (int i = 0; i <= static_cast<int>(LawId::isotropic); ++i) text += word_of(static_cast<LawId>(i));
  for (const std::string& body : joint.bodies) text += "\n" + body;
  std::vector<Expr> expressions;
  for (const Row& row : joint.rows) {
    text += fmt::format("\n{} {}\n", row.name, static_cast<int>(row.kind));
    expressions.push_back(row.C);
  }
  add(derivation.rows, text, expressions);
  for (const Block& coordinate : derivation.coordinates) add(coordinate, text, expressions);
  if (derivation.law) add(*derivation.law, text, expressions);
  if (joint.law)
    for (const LawInput& input : joint.law->inputs)
      if (input.lower) expressions.insert(expressions.end(), {input.lower, input.upper});
  for (const DerivedBound& bound : derivation.bounded)
    if (bound.rate) expressions.insert(expressions.end(), {bound.rate, bound.acceleration});
  for (const DerivedBound& bound : derivation.bounded)
    if (bound.by_lower)
      expressions.insert(expressions.end(), {bound.lower, bound.upper, bound.by_lower, bound.by_upper});
  return hash_of(text + text_of_graph(*joint.pool, expressions));
}

std::vector<ProofRow> rows_of(const std::vector<Proved>& proofs, const Joint& joint, const std::string& statement) {
  std::vector<ProofRow> rows;
  for (const Proved& proved : proofs) {
    rows.push_back({name_of_space(joint), joint.name, proved.name.empty() ? "rows" : proved.name, statement,
                    words_of(proved.proof, Verdict::holds), words_of(proved.proof, Verdict::shown)});
  }
  return rows;
}

std::string shown_text(const std::vector<ProofRow>& rows) {
  std::string text;
  for (const ProofRow& row : rows) {
    std::string laws;
    for (const std::string& word : split(row.shown, ' ')) {
      laws += (laws.empty() ? "" : "; ") + std::string(name_of(law_of(word).value()));
    }
    if (laws.empty()) continue;
    text += fmt::format("{}{}: shown at {} random points, too expensive to prove: {}\n", row.joint,
                        row.block == "rows" ? "" : ", coordinate " + row.block, exact_points, laws);
  }
  return text;
}

ProofRecord::ProofRecord(const std::string& csv) {
  for (const std::string& line : split(csv, '\n')) {
    std::vector<std::string> fields = split(line, ',');
    if (fields.size() == 5) fields.emplace_back();  // nothing is merely shown
    if (fields.size() != 6 || !are_laws(fields[4]) || !are_laws(fields[5])) continue;
    rows_[{fields[0], fields[1]}].push_back({fields[0], fields[1], fields[2], fields[3], fields[4], fields[5]});
  }
}

std::vector<ProofRow> ProofRecord::find(const Derivation& derivation, const std::string& statement) const {
  const auto found = rows_.find({name_of_space(derivation.joint), derivation.joint.name});
  if (found == rows_.end() || found->second.size() != 1 + derivation.coordinates.size()) return {};
  for (const ProofRow& row : found->second) {
    if (row.statement != statement) return {};
  }
  return found->second;
}

std::string csv_of(std::vector<ProofRow> rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const ProofRow& a, const ProofRow& b) {
    return std::tie(a.space, a.joint) < std::tie(b.space, b.joint);
  });
  std::string csv = header;
  for (const ProofRow& r : rows) {
    csv += fmt::format("{},{},{},{},{},{}\n", r.space, r.joint, r.block, r.statement, r.proved, r.shown);
  }
  return csv;
}

}  // namespace cdot::derive
