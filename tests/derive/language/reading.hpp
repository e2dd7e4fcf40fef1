// What the reader's tests and its fuzzer share: reading joints and hand derivations without a
// derivation behind them.
#pragma once

#include <string>

#include "derive/language/hand/hand.hpp"
#include "derive/language/read.hpp"

namespace cdot::derive {

// Stands in for what Cdot derives: matrices of the right size whose entries are free symbols.
GeneratedRows stand_in(const ReadResult& read);

// Every message about a file of hand derivations, its remarks and the formulas that have no value,
// as text.
std::string messages_about_hand(const std::shared_ptr<const SourceFile>& hand,
                                const std::shared_ptr<const SourceFile>& joint, const Library& library);

// The specs of a folder, named without the folder, so that messages are the same everywhere.
Library library_of(const std::filesystem::path& folder);
std::shared_ptr<const SourceFile> file_of(const std::filesystem::path& path);

}  // namespace cdot::derive
