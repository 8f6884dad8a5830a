#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>
#include <meshgraft/script/run_edit.h>

namespace meshgraft {

struct LoadedInputs;

/// Names how a comparison solves an edit: by a method, or a preset with a method and all its settings.
using Contender = std::variant<DeformMethod, Baseline, Preset>;

/// Returns the name, such as "corotational" or "as-published".
std::string_view to_string(const Contender& value);

/// Returns this library's methods, its preset, then the published methods.
std::vector<Contender> all_contenders();

/// Returns the contender of that name. Throws Error(usage) like `method_named`.
Contender contender_named(std::string_view name);

/// The result of an edit by one contender.
struct MethodOutcome {
  Contender method;
  std::optional<EditResult> result;  ///< absent where the method failed
  std::optional<Error> failure;      ///< absent where there is a result
};

/// The results of one edit by several methods.
struct Comparison {
  std::string edit;                  ///< the edit file
  std::vector<std::string> outputs;  ///< files written in addition to those in the outcomes' reports
  std::vector<MethodOutcome> outcomes;
};

/// Runs an edit once by each of `methods`, all its steps by that method; the inputs are read once. Published
/// methods run by their own defaults; of the settings they take `backend` and `refine_boundary`. A preset takes
/// the place of all settings, as in `RunOptions`. A method that fails becomes an outcome with its error.
///
/// Throws what `run_edit` throws for inputs and if cancelled, and the first method's error where all methods
/// fail. Throws Error(usage) if no method is given or one is given twice, Error(input) for an edit without a
/// deform step.
Comparison compare_methods(const EditFile& edit, std::span<const Contender> methods,
                           const Context& context = {});
/// Does the same with inputs that are loaded.
Comparison compare_methods(const EditFile& edit, const LoadedInputs& inputs, std::span<const Contender> methods,
                           const Context& context = {});

/// Returns each method's name, quality and seconds as a Markdown table, with notes below it, in the words of an
/// interface.
std::string comparison_table(const Comparison& comparison, const Wording& wording = library_text);

/// Returns the comparison as JSON (docs/report.md), in the words of an interface.
std::string write_comparison(const Comparison& comparison, const Wording& wording = library_text);

}  // namespace meshgraft
