#include "help_formatter.h"

#include <set>

#include "command_tree.h"

namespace meshgraft::cli {

namespace {

std::string names_of(const std::string& label, const std::set<CLI::Option*>& options) {
  std::string names;
  for (const CLI::Option* option : options) names += " " + option->get_name();
  return names.empty() ? "" : " " + label + ":" + names;
}

bool is_repeatable(const CLI::Option& option) {
  return option.get_expected_max() >= CLI::detail::expected_max_vector_size;
}

}  // namespace

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  std::string text;
  if (takes_value(*option)) {
    const std::string type = option->get_type_name();
    text = option->get_expected_min() == 0 ? " [" + type + "]" : " " + type;
    if (is_repeatable(*option)) text += " ...";
    if (option->get_required()) text += " " + get_label("REQUIRED");
  }
  return text + names_of(get_label("Needs"), option->get_needs()) +
         names_of(get_label("Excludes"), option->get_excludes());
}

std::string HelpFormatter::make_option_usage(const CLI::Option* option) const {
  const bool several = option->get_items_expected_max() > 1;
  const std::string name = option->get_type_name() + (several ? "..." : "");
  return option->get_required() ? name : "[" + name + "]";
}

}  // namespace meshgraft::cli
