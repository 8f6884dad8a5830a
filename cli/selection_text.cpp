#include "selection_text.h"

#include <meshgraft/core/error.h>

#include "cli/facts.h"
#include "values.h"

namespace meshgraft::cli {

namespace {

EditSelection beyond(double length, const std::vector<Index>& loops) {
  EditSelection::Union start;
  for (const Index loop : loops) start.of.push_back({Selection::Loop{loop}});
  const EditSelection near{
      EditSelection::GrowLength{std::make_shared<const EditSelection>(EditSelection{start}), length}};
  return {EditSelection::Minus{{EditSelection{Selection::All{}}, near}}};
}

EditSelection box(const std::vector<double>& values, const std::string& option) {
  if (values.size() != 6) throw Error(facts::cli::NotABox{.count = values.size()}, Location::place(option));
  return {Selection::Box{Eigen::Map<const Eigen::Vector3d>(values.data()),
                         Eigen::Map<const Eigen::Vector3d>(values.data() + 3)}};
}

template <class Number>
Number one_number(const std::string& text, const std::string& option) {
  const auto values = numbers<Number>(text, option);
  if (values.size() != 1) throw Error(facts::cli::NotOneNumber{.text = text}, Location::place(option));
  return values.front();
}

}  // namespace

EditSelection selection_from(const std::string& text, const std::vector<Index>& loops,
                             const std::string& option) {
  if (text.starts_with('{')) return parse_selection(text, option);
  const std::size_t colon = text.find(':');
  const std::string word = text.substr(0, colon);
  const std::string rest = colon == std::string::npos ? std::string() : text.substr(colon + 1);
  if (!rest.empty()) {
    if (word == "loop") return {Selection::Loop{one_number<Index>(rest, option)}};
    if (word == "indices") return {Selection::Indices{numbers<Index>(rest, option)}};
    if (word == "file") return {EditSelection::IndexFile{rest}};
    if (word == "box") return box(numbers<double>(rest, option), option);
    if (word == "beyond") return beyond(one_number<double>(rest, option), loops);
  }
  throw Error(facts::cli::NotASelection{.text = text, .forms = selection_forms}, Location::place(option));
}

}  // namespace meshgraft::cli
