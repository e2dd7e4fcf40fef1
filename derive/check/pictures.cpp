// The poses of a report, drawn: a part of a page for each spec.
#include <algorithm>
#include <fmt/format.h>

#include "derive/check/check.hpp"
#include "derive/check/parts.hpp"
#include "derive/explain/formats/mathml.hpp"
#include "derive/picture/picture.hpp"
#include "runtime/text/html.hpp"

namespace cdot::derive {
namespace {

constexpr const char* introduction =
    "<p>At a singular pose some impulses do not change Cdot, so K has no inverse. At a guarded pose a length or a "
    "divisor "
    "is 0, and the kernel takes the value that the caption tells. Bodies are outlines around their centres and points, "
    "with their axes. What the spec names has its name; a ring marks a vector that is zero.</p>\n";

bool any_to_show(const std::vector<PoseToDraw>& poses) {
  return std::ranges::any_of(poses, [](const PoseToDraw& pose) { return pose.why != PoseToDraw::Why::regular; });
}

std::string sentence(std::string words) {
  if (words[0] >= 'a' && words[0] <= 'z') words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words + ".";
}

std::string why_none(const CheckReport& report) {
  if (!report.readable) return "The spec cannot be read.";
  for (const Finding& f : report.findings)
    if (f.level == Level::error) return "The spec has errors: " + f.message + ".";
  for (const Finding& f : report.findings)
    if (f.kind == "singular") return "No pose to draw: " + f.message + ".";
  return "No pose with C = 0 was found.";
}

std::string figure(const Joint& joint, const PoseToDraw& pose, const std::string& picture) {
  std::string numbers;
  for (const std::string& line : numbers_of(joint, pose.pose)) numbers += text::html_escaped(line) + "\n";
  return fmt::format(
      "<figure>\n{}<figcaption>{}<details><summary>Its "
      "numbers</summary><pre>{}</pre></details></figcaption></figure>\n",
      picture, text::html_escaped(sentence(pose.words)), numbers);
}

std::string figures(const Joint& joint, const std::vector<PoseToDraw>& to_draw) {
  std::vector<Sample> poses;
  for (const PoseToDraw& pose : to_draw) poses.push_back(pose.pose);
  const std::vector<std::string> pictures = pictures_of(joint, poses);
  std::string out = "<div class=\"poses\">\n";
  for (std::size_t i = 0; i < poses.size(); ++i) out += figure(joint, to_draw[i], pictures[i]);
  return out + "</div>\n";
}

}  // namespace

std::string pictures_html(const ReadResult& read, const CheckReport& report) {
  const std::string name = read.joint ? read.joint->name : read.file->path;
  std::string out = fmt::format("<section><h2>{}</h2>\n", text::html_escaped(name));
  if (read.joint && !read.joint->title.empty())
    out += fmt::format("<p>{}</p>\n", text::html_escaped(read.joint->title));
  if (!any_to_show(report.poses))
    return out + fmt::format("<p>{}</p>\n</section>\n", text::html_escaped(why_none(report)));
  return out + figures(*read.joint, report.poses) + "</section>\n";
}

std::string singular_poses_html(const Derivation& derivation) {
  const std::vector<PoseToDraw> poses = poses_to_draw(derivation);
  if (!any_to_show(poses)) return "";
  return fmt::format(
      "<style>{}</style>\n<section><h2>Where K is singular, or a guard of the kernel acts</h2>\n{}{}</section>\n",
      picture_style, introduction, figures(derivation.joint, poses));
}

std::string pictures_page(const std::string& parts) {
  return html_head("Where K is singular, or a guard of the kernel acts",
                   std::string("body { max-width: 60rem; }\n") + picture_style) +
         introduction + parts + html_foot;
}

}  // namespace cdot::derive
