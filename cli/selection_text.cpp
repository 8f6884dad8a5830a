#include "selection_text.h"

#include <meshgraft/core/error.h>

#include "cli/facts.h"
#include "values.h"

namespace meshgraft::cli {

namespace {

SelectionSpec beyond(double length, const std::vector<Index>& loops) {
  SelectionSpec::Union start;
  for (const Index loop : loops) start.of.push_back({Selection::Loop{loop}});
  const SelectionSpec near{
      SelectionSpec::GrowLength{std::make_shared<const SelectionSpec>(SelectionSpec{start}), length}};
  return {SelectionSpec::Minus{{SelectionSpec{Selection::All{}}, near}}};
}

SelectionSpec box(const std::vector<double>& values, const std::string& option) {
  if (values.size() != 6) throw Error(facts::cli::NotABox{.count = values.size()}, option);
  return {Selection::Box{Eigen::Map<const Eigen::Vector3d>(values.data()),
                         Eigen::Map<const Eigen::Vector3d>(values.data() + 3)}};
}

double one_number(const std::string& text, const std::string& option) {
  const auto values = numbers<double>(text, option);
  if (values.size() != 1) throw Error(facts::cli::NotOneNumber{.text = text}, option);
  return values.front();
}

}  // namespace

SelectionSpec selection_from(const std::string& text, const std::vector<Index>& loops,
                             const std::string& option) {
  if (text.starts_with('{')) return parse_selection(text, option);
  const std::size_t colon = text.find(':');
  const std::string word = text.substr(0, colon);
  const std::string rest = colon == std::string::npos ? std::string() : text.substr(colon + 1);
  if (!rest.empty()) {
    if (word == "loop") return {Selection::Loop{numbers<Index>(rest, option).front()}};
    if (word == "indices") return {Selection::Indices{numbers<Index>(rest, option)}};
    if (word == "file") return {SelectionSpec::IndexFile{rest}};
    if (word == "box") return box(numbers<double>(rest, option), option);
    if (word == "beyond") return beyond(one_number(rest, option), loops);
  }
  throw Error(facts::cli::NotASelection{.text = text, .forms = selection_forms}, option);
}

}  // namespace meshgraft::cli
