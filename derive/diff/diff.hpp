// Published derivations to verdicts, entry by entry, by comparison with the generated ones. Exact arithmetic modulo a
// prime decides equality; doubles decide where it cannot. Finite differences confirm each difference.
#pragma once

#include <string>
#include <vector>

#include "derive/kernel/ledger.hpp"
#include "derive/language/hand/hand.hpp"
#include "derive/language/specs_folder.hpp"

namespace cdot::derive {

enum class Agreement { agrees, agrees_if, differs, listed };
std::string_view name_of(Agreement agreement);  // "agrees-if"

// One place where a hand derivation differs.
struct Difference {
  std::string what;         // C, Cdot, J, K, b, update
  std::string row, column;  // "1", "w_b"; empty where there are none
  std::string kind;         // sign, factor, wrong body, missing term, extra term, transposed, undeclared
                            // assumption; of a whole matrix also order, inverse, frame
  std::string generated, hand,
      difference;  // infix, in the spec's names; difference = hand - generated
  std::string sentence;
  std::string confirmed;  // by finite differences: how far the generated and the published value
                          // are off; may be empty
  Span where;
};

// One judged formula for a page, as HTML with MathML: both sides with their wrong entries marked.
struct Sheet {
  std::string what;                  // "K", "update", "claim on C"
  std::string published, generated;  // alike where nothing differs
};

struct Judgement {
  std::string id, joint, title, source, note;
  Agreement agreement = Agreement::agrees;
  std::string condition;  // of agrees_if; the reason of listed
  std::vector<Difference> differences;
  std::vector<std::string> remarks;  // the sign of C, broken momentum, how equality was decided
  std::vector<LedgerRow> costs;      // of what agrees
  std::vector<Sheet> sheets;         // if they are asked for
  std::vector<std::string> names;    // MathML "u = pa - pb" for each name in the sheets
  Span where;
};

struct DiffReport {
  std::shared_ptr<const SourceFile> file;
  std::vector<Judgement> judgements;
  Diagnostics diagnostics;  // entries that cannot be read
};

// Judges every entry of a .hand file against the spec beside it, as it was read.
DiffReport judge(const std::filesystem::path& hand, const ReadResult& spec, bool with_sheets = false);

struct ReportOptions {
  bool all = false;   // also what agrees, in a line each
  bool full = false;  // whole formulas, however long; else three lines for each difference
};
std::string to_text(const DiffReport& report, const ReportOptions& options);
std::string to_json(const DiffReport& report);
std::string joined_json(const std::vector<std::string>& arrays);  // of several reports, as one

// An entry in the page of all: its HTML without the frame that carries its anchor.
struct Exhibit {
  std::string id, joint, title, html;  // joint: "planar/line"
  Agreement agreement = Agreement::agrees;
};
std::vector<Exhibit> exhibits_of(const DiffReport& report);  // judged with sheets
std::string page_of(const std::vector<Exhibit>& exhibits);   // one file that needs nothing else

}  // namespace cdot::derive
