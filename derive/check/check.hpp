// A spec to its errors and risks, before any code exists.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "derive/language/read.hpp"
#include "derive/numbers/numeric.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {

enum class Level {
  note,     // information for the author: where K is singular, what the kernel does at 1/0
  warning,  // likely a mistake
  error     // no kernel should be made of this
};

struct Finding {
  Level level = Level::note;
  std::string kind;  // one word per kind of finding, for programs: "momentum", "vanishing", "singular", ...
  Span where;
  std::vector<Span> also;
  std::string message, fix;
};

struct Findings : std::vector<Finding> {
  void add(Level level, std::string kind, Span where, std::string message, std::string fix = {}) {
    push_back({level, std::move(kind), where, {}, std::move(message), std::move(fix)});
  }
};

struct PoseToDraw {
  enum class Why { regular, singular, guarded } why = Why::regular;  // guarded: a guard of the kernel acts
  std::string words;                                                 // a sentence without its full stop
  Sample pose;
};

struct CheckReport {
  bool readable = true;
  Findings findings;           // in the order of the text; errors first where they stand at one place
  std::vector<Proved> proofs;  // of the rows and of each coordinate
  // If they are asked for: a regular one, one for each way to be singular, and some at which a guard acts.
  std::vector<PoseToDraw> poses;

  bool clean() const;  // nothing but notes
};

enum class Draw { no, yes };
CheckReport check(const ReadResult& read, Draw draw = Draw::no);

// The poses of a report as pictures with captions, or the sentence why there are none: a part of a page.
std::string pictures_html(const ReadResult& read, const CheckReport& report);
// The same for one derivation, without its proofs and its name; empty if all poses are regular.
std::string singular_poses_html(const Derivation& derivation);
// One page of these parts.
std::string pictures_page(const std::string& parts);

std::string_view name_of(Level level);
std::string render(const SourceFile& file, const Finding& finding);

}  // namespace cdot::derive
