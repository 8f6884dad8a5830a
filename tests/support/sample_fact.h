#pragma once

#include <string>
#include <vector>

#include <meshgraft/core/error.h>

namespace meshgraft::test {

/// Returns a fact of this class, with plausible values.
inline Fact sample_fact(const FactType& type) {
  std::vector<FieldValue> values;
  for (const FieldType& field : type.fields) switch (field.kind) {
      case FieldKind::integer: values.emplace_back(std::int64_t{3}); break;
      case FieldKind::number: values.emplace_back(0.5); break;
      case FieldKind::text: values.emplace_back(std::string("arm")); break;
      case FieldKind::integers: values.emplace_back(std::vector<std::int64_t>{1, 2}); break;
      case FieldKind::numbers: values.emplace_back(std::vector<double>{0.5, 1.5}); break;
      case FieldKind::texts: values.emplace_back(std::vector<std::string>{"arm", "leg"}); break;
      case FieldKind::word: values.emplace_back(std::string(field.words.front().name)); break;
    }
  return {type, std::move(values)};
}

}  // namespace meshgraft::test
