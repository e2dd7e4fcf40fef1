// Formulas as MathML, and the frame of a page that needs nothing else: light and dark, without scripts. The page is
// XML, too.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "derive/explain/formula.hpp"

namespace cdot::derive {

std::string html_prose(const std::string& words);  // with `code` between backticks
std::string in_mathml(const Formula& formula, const std::vector<std::string>& bodies);

// Up to the heading of the page; `more_style` comes after the common style sheet.
std::string html_head(const std::string& title, std::string_view more_style = {});
constexpr const char* html_foot = "</body>\n</html>\n";

}  // namespace cdot::derive
