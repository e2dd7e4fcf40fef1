#include "derive/pipeline/pipeline.hpp"

#include <fmt/format.h>

#include "derive/derivation/free_coordinates.hpp"
#include "derive/diff/diff.hpp"
#include "derive/pipeline/serialise.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

fs::path hand_beside(fs::path spec) { return spec.replace_extension(".hand"); }

// Says everything that is wrong with it.
void prove_spec(const ReadResult& read, Outcome& outcome) {
  outcome.complaints += render(*read.file, read.diagnostics);
  outcome.proved = read.joint.has_value();
  if (!read.joint) return;
  for (const Coordinate& held : held_coordinates(*read.joint)) {
    outcome.proved = false;
    outcome.complaints += render(*read.file, held_error(held));
  }
  for (const Law& law : prove(*read.joint, derive_rows(*read.joint)).laws) {
    if (law.verdict == Verdict::shown) {
      outcome.said += fmt::format("{}: shown at {} random points, too much to prove: {}\n", read.joint->name,
                                  exact_points, name_of(law.id));
    }
    if (law.verdict != Verdict::fails && law.verdict != Verdict::undecided) continue;
    outcome.proved = false;
    Diagnostics said;
    const Span where = law.row ? law.row->where : Span{};
    said.error(where, fmt::format("{}: {}", name_of(law.id), law.text), law.fix, law.parts);
    outcome.complaints += render(*read.file, said);
  }
}

// Two of the derivations may be about the same that the ledger does not have otherwise.
void judge_hand(const fs::path& spec, const SpecsFolder& folder, Outcome& outcome) {
  const fs::path hand = hand_beside(spec);
  if (!fs::exists(hand)) return;
  const DiffReport report = judge(hand, spec, folder);
  outcome.complaints += render(*report.file, report.diagnostics);
  for (const Judgement& j : report.judgements) {
    outcome.hand_costs.insert(outcome.hand_costs.end(), j.costs.begin(), j.costs.end());
  }
}

// Everything that the outcome depends on.
std::string key_of(const fs::path& spec, const SpecsFolder& folder, const std::string& program) {
  const ReadResult read = folder.read(spec);
  Parcel key;
  key.put(program);
  key.put(spec.string());  // as messages name it
  key.put(read.file->text);
  key.put(fs::exists(hand_beside(spec)) ? "hand" : "");
  if (fs::exists(hand_beside(spec))) key.put(load_source(hand_beside(spec))->text);
  for (const auto& included : read.included) key.put(included->path), key.put(included->text);
  return key.content();
}

void put(Parcel& parcel, const std::vector<LedgerRow>& rows) {
  parcel.put(static_cast<int>(rows.size()));
  for (const LedgerRow& r : rows) {
    for (const std::string& text : {r.space, r.joint, r.block, r.quantity, r.source}) parcel.put(text);
    const Count& c = r.count;
    for (const int count : {c.add, c.multiply, c.divide, c.root, c.compare, c.call}) parcel.put(count);
  }
}

std::vector<LedgerRow> ledger_rows(Unpacking& parcel) {
  std::vector<LedgerRow> rows(static_cast<std::size_t>(parcel.number()));
  for (LedgerRow& r : rows) {
    for (std::string* text : {&r.space, &r.joint, &r.block, &r.quantity, &r.source}) *text = parcel.text();
    Count& c = r.count;
    for (int* count : {&c.add, &c.multiply, &c.divide, &c.root, &c.compare, &c.call}) *count = parcel.number();
  }
  return rows;
}

}  // namespace

Outcome derive_spec(const fs::path& spec, const SpecsFolder& folder) {
  Outcome outcome;
  const ReadResult read = folder.read(spec);
  prove_spec(read, outcome);
  if (!outcome.proved) return outcome;
  outcome.joint = generate(*read.joint);
  judge_hand(spec, folder, outcome);
  return outcome;
}

Outcome derive_spec(const fs::path& spec, const SpecsFolder& folder, const Memory& memory, const std::string& program,
                    bool fresh) {
  if (program.empty()) return derive_spec(spec, folder);
  const std::string key = key_of(spec, folder, program);
  if (!fresh) {
    if (const std::optional<std::string> known = memory.recall(key)) {
      Outcome outcome = unpacked_outcome(*known);
      outcome.remembered = true;
      return outcome;
    }
  }
  Outcome outcome = derive_spec(spec, folder);
  const bool unchanged = key_of(spec, folder, program) == key;  // by somebody else, meanwhile
  if (outcome.proved && unchanged) memory.keep(key, packed(outcome));
  return outcome;
}

std::string packed(const Outcome& outcome) {
  Parcel parcel;
  parcel.put(outcome.proved ? 1 : 0);
  parcel.put(outcome.remembered ? 1 : 0);
  for (const std::string& text :
       {outcome.said, outcome.complaints, outcome.joint.space, outcome.joint.name, outcome.joint.kernel}) {
    parcel.put(text);
  }
  put(parcel, outcome.joint.ledger);
  put(parcel, outcome.hand_costs);
  return parcel.content();
}

Outcome unpacked_outcome(const std::string& content) {
  Unpacking parcel(content);
  Outcome outcome;
  outcome.proved = parcel.number() == 1;
  outcome.remembered = parcel.number() == 1;
  for (std::string* text :
       {&outcome.said, &outcome.complaints, &outcome.joint.space, &outcome.joint.name, &outcome.joint.kernel}) {
    *text = parcel.text();
  }
  outcome.joint.ledger = ledger_rows(parcel);
  outcome.hand_costs = ledger_rows(parcel);
  return outcome;
}

}  // namespace cdot::derive
