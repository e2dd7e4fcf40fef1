#include "derive/pipeline/pipeline.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/derivation/free_coordinates.hpp"
#include "derive/diff/diff.hpp"
#include "runtime/text/stage.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

void complain(const SourceFile& file, const Diagnostic& diagnostic, Outcome& outcome) {
  outcome.proved = false;
  outcome.complaints += render(file, diagnostic);
}

// Fills in the errors, or the proofs.
void prove_derivation(const Derivation& derivation, const ProofRecord& record, Outcome& outcome) {
  const Joint& joint = derivation.joint;
  for (const Diagnostic& held : errors_of_constrained_coordinates(joint)) complain(*joint.file, held, outcome);
  const std::string statement = statement_of(derivation);
  outcome.proofs = record.find(derivation, statement);
  outcome.on_record = !outcome.proofs.empty();
  if (!outcome.on_record) {
    const text::Stage stage("proving");
    const std::vector<Proved> proofs = prove(derivation);
    bool undecided = false;
    for (const Proved& proved : proofs) {
      for (const Law& law : proved.proof.laws) {
        if (!is_broken(law)) continue;
        // Algebra does not decide some laws, as of coordinates with arctangents: each run reports them, none records
        // them.
        if (law.verdict == Verdict::undecided && !proved.name.empty()) {
          outcome.said += fmt::format("{}: {}: {}\n", joint.name, name_of(law.id), law.text);
          undecided = true;
          continue;
        }
        const Span where = law.row != nullptr ? law.row->where : proved.where;
        const std::string text = fmt::format("{}: {}", name_of(law.id), law.text);
        complain(*joint.file, {Severity::error, where, law.parts, text, law.fix}, outcome);
      }
    }
    if (!undecided) outcome.proofs = rows_of(proofs, joint, statement);
  }
  outcome.said += shown_text(outcome.proofs);
}

// A warning with the number of functions that may be too long, and the longest of them.
std::string warning_of(const std::vector<CutShort>& cut_short, const Joint& joint) {
  if (cut_short.empty()) return "";
  const CutShort& longest = *std::ranges::max_element(cut_short, {}, &CutShort::operations);
  const std::string text = fmt::format(
      "functions of the kernel that may have more operations than need be: {}; the longest is {}, with {} operations. "
      "The search for shorter programs ended at its bound of counted work",
      cut_short.size(), longest.function, longest.operations);
  Diagnostics warning;
  warning.warning(joint.rows.empty() ? Span{} : joint.rows.front().where, text,
                  "none is needed: the kernel is right, only slower");
  return render(*joint.file, warning);
}

// Adds the costs of the published derivations beside it, as far as they are right.
void judge_hand(const fs::path& spec, const ReadResult& read, Outcome& outcome) {
  const fs::path hand = fs::path(spec).replace_extension(".hand");
  if (!fs::exists(hand)) return;
  const DiffReport report = judge(hand, read);
  outcome.complaints += render(*report.file, report.diagnostics);
  for (const Judgement& j : report.judgements) {
    outcome.hand_costs.insert(outcome.hand_costs.end(), j.costs.begin(), j.costs.end());
  }
}

}  // namespace

Outcome derive_spec(const fs::path& spec, const SpecsFolder& folder, const ProofRecord& record, SearchBounds bounds,
                    const UseKernel& use) {
  const text::Stage stage("deriving");
  Outcome outcome;
  const ReadResult read = folder.read(spec);  // text to C(q) = 0
  outcome.complaints = render(*read.file, read.diagnostics);
  outcome.proved = read.joint.has_value();
  if (!outcome.proved) return outcome;
  const Derivation derivation = derive(*read.joint);  // C to Cdot, J, K, gamma; also with a body immovable
  prove_derivation(derivation, record, outcome);      // by GiNaC, all of it
  if (!outcome.proved) return outcome;
  const text::Stage simplifying("simplifying the kernel");
  std::vector<CutShort> cut_short;
  const Kernel planned = plan(derivation);                        // one program a function
  const Kernel kernel = simplified(planned, &cut_short, bounds);  // common terms and factors shared
  outcome.complaints += warning_of(cut_short, derivation.joint);
  if (use) {
    use(kernel);
    return outcome;
  }
  outcome.joint = print(kernel);  // C++ and what it costs
  const text::Stage judging("comparing hand derivations");
  judge_hand(spec, read, outcome);
  return outcome;
}

}  // namespace cdot::derive
